// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/scene_file.h"

#include "bindings.h"

namespace cg2raw::python {

void bind_scene_file(py::module_& m)
{
    py::class_<SceneLayer>(m, "SceneLayer")
        .def_readonly("name", &SceneLayer::name)
        .def_readonly("part", &SceneLayer::part)
        .def_readonly("channels", &SceneLayer::channels)
        .def_readonly("alpha", &SceneLayer::alpha);
    m.attr("raw_already") = raw_already;
    py::class_<FrameName>(m, "FrameName")
        .def_readonly("before", &FrameName::before)
        .def_readonly("number", &FrameName::number)
        .def_readonly("after", &FrameName::after);
    m.def("frame_name", &frame_name, "path"_a,
          "Return the frame number in a file's path, and the text before and after it; "
          "None if there is none.");
}

} // namespace cg2raw::python

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
    m.def(
        "beauty_layer",
        [](const std::vector<std::pair<std::string, std::vector<std::string>>>& parts,
           const std::string& asked, const std::string& option) {
            std::vector<ScenePart> scene;
            for (const auto& [name, channels] : parts)
                scene.push_back({ name, channels });
            return beauty_layer(scene, asked, { option });
        },
        "parts"_a, "asked"_a = "", "option"_a = "--layer",
        "Return the picture among the layers of (name, channel names) parts of a file; "
        "option is how one is asked for, for messages. Raises Error.");
    m.def("frame_from_name", &frame_from_name, "path"_a,
          "Return the frame number in a file's name, None if there is none.");
    m.def("frame_from_time_code", &frame_from_time_code, "text"_a,
          "Return the digits of an SMPTE time code hh:mm:ss:ff, None of other texts.");
}

} // namespace cg2raw::python

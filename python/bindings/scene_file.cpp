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
           const std::string& asked, const std::string& option,
           const std::vector<std::string>& data) {
            std::vector<ScenePart> scene;
            for (const auto& [name, channels] : parts)
                scene.push_back({ name, channels });
            const auto typed
                = [&](const std::string& name) { return option + " " + name; };
            return beauty_layer(scene, asked, { typed, false, data });
        },
        "parts"_a, "asked"_a = "", "option"_a = "--layer",
        "data"_a = std::vector<std::string>(),
        "Return the picture among the layers of (name, channel names) parts of a file; "
        "option is how one is asked for, for messages; data are starts of names of "
        "layers "
        "that are no pictures. Raises Error.");
    m.attr("raw_already") = raw_already;
    py::class_<FrameName>(m, "FrameName")
        .def_readonly("before", &FrameName::before)
        .def_readonly("number", &FrameName::number)
        .def_readonly("after", &FrameName::after);
    m.def("frame_name", &frame_name, "path"_a,
          "Return the frame number in a file's path, and the text before and after it; "
          "None if there is none.");
    m.def("frame_from_time_code", &frame_from_time_code, "text"_a,
          "Return the digits of an SMPTE time code hh:mm:ss:ff, None of other texts.");
}

} // namespace cg2raw::python

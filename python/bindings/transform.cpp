// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "bindings.h"

namespace cg2raw::python {

void bind_transform(py::module_& m)
{
    py::class_<CameraTransform>(
        m, "CameraTransform",
        "Scene-linear Rec.709 -> camera RGB:\n"
        "balanced = clip(second clip(first scene)), camera = highlights(balanced, "
        "gains).")
        .def_property_readonly(
            "first", [](const CameraTransform& t) { return array_of(t.first); },
            "(3, 3): balanced camera (paper: XYZ) from linear sRGB.")
        .def_readonly("two_steps", &CameraTransform::two_steps,
                      "Whether there is a clip to 0..1 between the two products.")
        .def_property_readonly(
            "second", [](const CameraTransform& t) { return array_of(t.second); },
            "(3, 3): balanced camera from XYZ in convention paper, else identity.")
        .def_readonly("gains", &CameraTransform::gains,
                      "White balance undone, times the digital gain.")
        .def_readonly("keep_highlights", &CameraTransform::keep_highlights)
        .def_readonly("clip_result", &CameraTransform::clip_result,
                      "Whether the result is clipped to 0..1.")
        .def_readonly("is_light", &CameraTransform::is_light,
                      "Whether nothing is clipped but negative light.")
        .def_property_readonly(
            "uplift",
            [](const CameraTransform& t) -> py::object {
                if (!t.uplift)
                    return py::none();
                return py::array_t<double>({ 3, 7 }, t.uplift->front().data());
            },
            "(3, 7) in convention spectral, else None: balanced camera from r, g, b,\n"
            "sqrt(rg), sqrt(gb), sqrt(rb) and m (rgb / m^3)^8 with m = (r + g + b) / "
            "3,\n"
            "of linear sRGB; in place of first.")
        .def_readonly(
            "spectrum", &CameraTransform::spectrum,
            "Light whose power was taken in convention spectral, else empty.");
    m.def(
        "camera_from_scene",
        [](const SensorProfile& profile, const Illuminant& illuminant,
           const std::string& convention, double digital_gain, bool highlights) {
            return camera_from_scene(profile, illuminant,
                                     convention_from_name(convention), digital_gain,
                                     highlights);
        },
        "profile"_a, "illuminant"_a, "convention"_a = "dng", "digital_gain"_a = 1.0,
        "highlights"_a = true,
        "The CameraTransform of a sensor under an Illuminant; nothing is drawn.\n\n"
        "Raises ValueError for a digital gain outside 0 to 1000.");
}

} // namespace cg2raw::python

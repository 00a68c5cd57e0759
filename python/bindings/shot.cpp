// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "bindings.h"
#include "constructor.h"

#include "cg2raw/dng_description.h"

#include <variant>

namespace cg2raw::python {
namespace {

using OptionalRate = std::optional<FrameRate>;
/// As people write it, or packed as files hold it.
using TimeCodeWord = std::variant<std::string, std::uint32_t>;

OptionalRate rate_of(const std::string& text)
{
    return text.empty() ? std::nullopt : OptionalRate(frame_rate_from_text(text));
}

std::optional<TimeCode> code_of(const TimeCodeWord& word, const OptionalRate& rate)
{
    if (const auto* packed = std::get_if<std::uint32_t>(&word))
        return time_code_from_packed(*packed, rate);
    const std::string& text = std::get<std::string>(word);
    return text.empty() ? std::nullopt : std::optional(time_code_from_text(text));
}

} // namespace

void bind_shot(py::module_& m)
{
    py::class_<Shot> shot(m, "Shot",
                          "What Exif says of the exposure, without its ISO.");
    def_constructor(
        shot,
        +[](std::optional<double> exposure_time, std::optional<double> f_number,
            std::optional<double> focal_length, const std::string& date_time_original,
            const std::string& artist, const std::string& copyright,
            const std::string& description, const std::string& lens_model,
            int orientation, const std::string& frame_rate,
            const TimeCodeWord& time_code, const std::string& reel_name,
            const std::string& camera_label, std::optional<double> pixel_aspect,
            std::optional<double> exposure_bias, std::optional<double> exposure_mode,
            std::optional<double> brightness) {
            const OptionalRate rate = rate_of(frame_rate);
            return plausible({ exposure_time, f_number, focal_length, std::nullopt,
                               exposure_bias, exposure_mode_from_number(exposure_mode),
                               brightness, date_time_original, artist, copyright,
                               description, lens_model, orientation, rate,
                               code_of(time_code, rate), reel_name, camera_label,
                               pixel_aspect });
        },
        py::kw_only(), "exposure_time"_a = py::none(), "f_number"_a = py::none(),
        "focal_length"_a = py::none(), "date_time_original"_a = "", "artist"_a = "",
        "copyright"_a = "", "description"_a = "", "lens_model"_a = "",
        "orientation"_a = 1, "frame_rate"_a = "", "time_code"_a = "",
        "reel_name"_a = "", "camera_label"_a = "", "pixel_aspect"_a = py::none(),
        "exposure_bias"_a = py::none(), "exposure_mode"_a = py::none(),
        "brightness"_a = py::none(),
        "Times in s, lengths in mm, dates as \"YYYY:MM:DD HH:MM:SS\", orientation "
        "1 to 8,\nframe rates as \"24\" or \"24000/1001\", time codes as "
        "\"hh:mm:ss:ff\" or packed,\npixel_aspect as width over height; what makes "
        "no sense is left out.");
    shot.def_readonly("exposure_time", &Shot::exposure_time, "s; None: not known.")
        .def_readonly("f_number", &Shot::f_number, "None: not known.")
        .def_property_readonly(
            "frame_rate",
            [](const Shot& shot) { return text_or_none(shot.frame_rate); },
            "Frames per second, \"24\" or \"24000/1001\"; None: not known.")
        .def_property_readonly(
            "time_code", [](const Shot& shot) { return text_or_none(shot.time_code); },
            "\"hh:mm:ss:ff\"; None: not known.");
}

} // namespace cg2raw::python

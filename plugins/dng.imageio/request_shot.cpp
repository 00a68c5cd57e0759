// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "request_shot.h"

namespace cg2raw {
namespace {

using OIIO::ImageSpec;

/// The first of the texts that @p spec has under @p names.
std::string text_of(const ImageSpec& spec, std::initializer_list<const char*> names)
{
    for (const char* name : names)
        if (const std::string text(spec.get_string_attribute(name)); !text.empty())
            return text;
    return "";
}

/// The rate that an image says; nothing if it makes no sense, which is no reason to
/// refuse a picture.
std::optional<FrameRate> rate_of(const ImageSpec& spec)
{
    const OIIO::ParamValue* const said = spec.find_attribute("FramesPerSecond");
    if (!said)
        return std::nullopt;
    try {
        return frame_rate_from_text(said->get_string());
    } catch (const Error&) {
        return std::nullopt;
    }
}

/// The time code that an image says, at @p rate.
std::optional<TimeCode> code_of(const ImageSpec& spec,
                                const std::optional<FrameRate>& rate)
{
    const OIIO::ParamValue* const said = spec.find_attribute("smpte:TimeCode");
    if (!said)
        return std::nullopt;
    if (said->type() == OIIO::TypeTimeCode)
        return time_code_from_packed(static_cast<const std::uint32_t*>(said->data())[0],
                                     rate);
    try {
        return time_code_from_text(said->get_string());
    } catch (const Error&) {
        return std::nullopt;
    }
}

/// The time code of @p frame, counted from the one that is asked for.
TimeCode counted_code(const Attributes& attributes,
                      const std::optional<FrameRate>& rate, std::int64_t frame)
{
    const std::string start = "dng:timecode " + text_of(*attributes.time_code);
    if (!rate)
        throw Error(start
                    + " counts how many frames a second? Add --attrib dng:framerate "
                      "24, or whatever it is");
    const std::int64_t first = attributes.first_frame.value_or(frame);
    if (!attributes.first_frame && frame != 0)
        throw Error(
            start + " is that of which frame? This one is " + std::to_string(frame)
            + ": add --attrib dng:first_frame NUMBER, that of the shot's first");
    if (frame < first)
        throw Error("frame " + std::to_string(frame) + " is before dng:first_frame "
                    + std::to_string(first) + ", whose time code is given");
    try {
        return advanced(*attributes.time_code, *rate, std::uint64_t(frame - first));
    } catch (const Error& error) {
        throw Error("dng:timecode: " + std::string(error.what()));
    }
}

} // namespace

Shot shot_of(const ImageSpec& spec, const Attributes& attributes, std::int64_t frame)
{
    Shot shot;
    const auto number = [&](const char* name) -> double {
        // OpenImageIO 2.4 makes no float of an int.
        return spec.get_float_attribute(name, float(spec.get_int_attribute(name, 0)));
    };
    shot.exposure_time = number("ExposureTime");
    shot.f_number = number("FNumber");
    shot.focal_length = number("Exif:FocalLength");
    shot.date_time_original = text_of(spec, { "Exif:DateTimeOriginal", "DateTime" });
    shot.artist = spec.get_string_attribute("Artist");
    shot.copyright = spec.get_string_attribute("Copyright");
    shot.description = spec.get_string_attribute("ImageDescription");
    shot.lens_model = spec.get_string_attribute("Exif:LensModel");
    shot.orientation = spec.get_int_attribute("Orientation", 1);
    shot.pixel_aspect = number("PixelAspectRatio");
    if (*shot.pixel_aspect == 0.0) // pixels per length: the wider, the fewer
        shot.pixel_aspect = number("YResolution") / number("XResolution");
    shot.frame_rate = attributes.frame_rate ? attributes.frame_rate : rate_of(spec);
    if (attributes.first_frame && !attributes.time_code)
        throw Error(
            "dng:first_frame is given without dng:timecode, which it is for: add "
            "--attrib dng:timecode 01:00:00:00, or leave it out");
    if (attributes.time_code)
        shot.time_code = counted_code(attributes, shot.frame_rate, frame);
    else
        shot.time_code = code_of(spec, shot.frame_rate);
    shot.reel_name = attributes.reel;
    if (shot.reel_name.empty())
        shot.reel_name = text_of(spec, { "reelName", "openexr:reelName" });
    shot.camera_label = attributes.camera_label;
    if (shot.camera_label.empty())
        shot.camera_label = text_of(spec, { "cameraLabel", "openexr:cameraLabel" });
    return plausible(shot);
}

} // namespace cg2raw

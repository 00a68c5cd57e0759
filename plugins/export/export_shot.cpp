// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What an image says of its exposure and of its place in a shot.
#include "rules.h"

#include <cmath>

namespace cg2raw {
namespace {

constexpr const char* time_code_name = "smpte:TimeCode";

/// What renderers and OpenEXR call what Exif has: docs/exposure.md lists whose they
/// are.
constexpr const char* f_number_names[] = { "FNumber", "cameraFNumber" };
constexpr const char* focal_length_names[]
    = { "Exif:FocalLength", "focalLength", "nominalFocalLength", "cameraFocalLength",
        "IFM_focalLength" };
constexpr const char* iso_names[] = { "Exif:PhotographicSensitivity",
                                      "Exif:ISOSpeedRatings", "isoSpeed", "cameraISO" };

/// Of the first name that states one; 0 if none does.
template <std::size_t count>
double first_number(const Metadata& metadata, const char* const (&names)[count])
{
    for (const char* name : names)
        if (const double number = metadata.number(name); number != 0.0)
            return number;
    return 0.0;
}

/// The rate that an image says; nothing if it makes no sense, which is no reason to
/// refuse a picture.
std::optional<FrameRate> stated_rate(const Metadata& metadata)
{
    const std::string text = metadata.text("FramesPerSecond");
    if (text.empty())
        return std::nullopt;
    try {
        return frame_rate_from_text(text);
    } catch (const Error&) {
        return std::nullopt;
    }
}

/// The time code that an image says, at @p rate.
std::optional<TimeCode> stated_code(const Metadata& metadata,
                                    const std::optional<FrameRate>& rate)
{
    const Metadata::Value* const said = metadata.find(time_code_name);
    if (!said)
        return std::nullopt;
    if (const auto* packed = std::get_if<Metadata::Numbers>(said))
        return packed->values.empty()
            ? std::nullopt
            : time_code_from_packed(std::uint32_t(packed->values.front()), rate);
    try {
        return time_code_from_text(std::get<std::string>(*said));
    } catch (const Error&) {
        return std::nullopt;
    }
}

/// Frames from the first of the shot, whose time code is an option.
std::uint64_t place_in_shot(const Given& given, const std::string& start,
                            std::int64_t frame)
{
    if (given.facts.place)
        return std::uint64_t(*given.facts.place);
    const auto& said = given.options.first_frame;
    const std::int64_t first = said.value_or(frame);
    if (!said && frame != 0)
        throw Error(start + " is that of which frame? This one is "
                    + std::to_string(frame) + ": add "
                    + given.option("first_frame", "NUMBER")
                    + ", that of the shot's first");
    if (frame < first)
        throw Error("frame " + std::to_string(frame) + " is before "
                    + given.option("first_frame") + " " + std::to_string(first)
                    + ", whose time code is given");
    return std::uint64_t(frame - first);
}

/// The time code of @p frame, counted from the one that is an option.
TimeCode counted_code(const Given& given, const std::optional<FrameRate>& rate,
                      std::int64_t frame)
{
    const TimeCode& first = *given.options.time_code;
    const std::string start = given.option("timecode") + " " + text_of(first);
    if (!rate)
        throw Error(start + " counts how many frames a second? Add "
                    + given.option("framerate", "24") + ", or whatever it is");
    const std::uint64_t frames = place_in_shot(given, start, frame);
    try {
        return advanced(first, *rate, frames);
    } catch (const Error& error) {
        throw Error(given.option("timecode") + ": " + error.what());
    }
}

/// Width over height of the pixels; 0 if nothing says it.
double pixel_aspect(const Metadata& metadata)
{
    if (const double stated = metadata.number("PixelAspectRatio"); stated != 0.0)
        return stated;
    const double x = metadata.number("XResolution"); // pixels per length
    return x == 0.0 ? 0.0 : metadata.number("YResolution") / x;
}

} // namespace

Shot stated_shot(const Metadata& metadata, const std::optional<FrameRate>& rate)
{
    Shot shot;
    shot.exposure_time = metadata.number("ExposureTime");
    shot.f_number = first_number(metadata, f_number_names);
    shot.focal_length = first_number(metadata, focal_length_names);
    if (const double iso = first_number(metadata, iso_names); iso >= 1.0 && iso <= 1e7)
        shot.iso = int(std::lround(iso));
    if (metadata.find("Exif:ExposureBiasValue"))
        shot.exposure_bias = metadata.number("Exif:ExposureBiasValue");
    if (metadata.find("Exif:BrightnessValue"))
        shot.brightness = metadata.number("Exif:BrightnessValue");
    if (metadata.find("Exif:ExposureMode"))
        shot.exposure_mode
            = exposure_mode_from_number(metadata.number("Exif:ExposureMode"));
    shot.date_time_original = metadata.text({ "Exif:DateTimeOriginal", "DateTime" });
    shot.artist = metadata.text("Artist");
    shot.copyright = metadata.text("Copyright");
    shot.description = metadata.text("ImageDescription");
    shot.lens_model = metadata.text("Exif:LensModel");
    if (const double orientation = metadata.number("Orientation");
        orientation >= 1.0 && orientation <= 8.0)
        shot.orientation = int(orientation);
    shot.pixel_aspect = pixel_aspect(metadata);
    shot.frame_rate = rate ? rate : stated_rate(metadata);
    shot.time_code = stated_code(metadata, shot.frame_rate);
    shot.reel_name = metadata.text({ "reelName", "openexr:reelName" });
    shot.camera_label = metadata.text({ "cameraLabel", "openexr:cameraLabel" });
    return plausible(shot);
}

Shot shot(const Given& given, const ImagePart& part, std::int64_t frame)
{
    const ExportOptions& options = given.options;
    if (options.first_frame && !options.time_code)
        throw Error(given.option("first_frame") + " is given without "
                    + given.option("timecode") + ", which it is for: add "
                    + given.option("timecode", "01:00:00:00") + ", or leave it out");
    Shot shot = stated_shot(part.metadata, options.frame_rate);
    if (options.time_code)
        shot.time_code = counted_code(given, shot.frame_rate, frame);
    else if (shot.time_code && shot.frame_rate)
        check(*shot.time_code, *shot.frame_rate);
    if (!options.reel.empty())
        shot.reel_name = options.reel;
    if (!options.camera_label.empty())
        shot.camera_label = options.camera_label;
    return shot;
}

std::optional<std::int64_t> time_code_frame(const Metadata& metadata)
{
    const Metadata::Value* const said = metadata.find(time_code_name);
    if (said && std::holds_alternative<std::string>(*said))
        return frame_from_time_code(std::get<std::string>(*said));
    const auto code = stated_code(metadata, std::nullopt);
    return code ? frame_from_time_code(text_of(*code)) : std::nullopt;
}

} // namespace cg2raw

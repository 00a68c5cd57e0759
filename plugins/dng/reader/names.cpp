// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What the camera is called, and what Exif says of the shot.
#include "reader/metadata_parts.h"

#include <cmath>

namespace cg2raw {
namespace {

constexpr Bounds iso_count { 1, 16 };
/// ISOSpeedRatings is 16 bits wide and says 65535 for more; the others hold the number.
constexpr std::int64_t iso_elsewhere = 65535;
constexpr Bounds iso_bounds { 0, 10000000 };
/// Eight for each time code; a frame has few.
constexpr Bounds time_code_bytes { 0, 65536 };

/// 0 is Exif's unknown.
std::optional<int> read_iso(const TiffTags& exif)
{
    std::int64_t iso = 0;
    if (exif.has(tag::iso_speed_ratings))
        iso = exif.integers(tag::iso_speed_ratings, iso_count, iso_bounds).front();
    for (TiffTag wide : { tag::recommended_exposure_index, tag::iso_speed })
        if ((iso == 0 || iso == iso_elsewhere) && exif.has(wide))
            iso = exif.integers(wide, iso_count, iso_bounds).front();
    return iso > 0 ? std::optional<int>(int(iso)) : std::nullopt;
}

/// What CinemaDNG calls one; what no camera runs at is unknown.
std::optional<FrameRate> read_frame_rate(const TiffTags& camera)
{
    const auto said = camera.fraction(tag::frame_rate);
    if (!said)
        return std::nullopt;
    try {
        return frame_rate_from_text(std::to_string(said->numerator) + "/"
                                    + std::to_string(said->denominator));
    } catch (const Error&) {
        return std::nullopt;
    }
}

/// The first of the time codes. Its bytes are those of a packed one, lowest first.
std::optional<TimeCode> read_time_code(const TiffTags& camera,
                                       const std::optional<FrameRate>& rate)
{
    if (!camera.has(tag::time_codes))
        return std::nullopt;
    const auto bytes = camera.bytes(tag::time_codes, time_code_bytes);
    if (bytes.size() < 4)
        return std::nullopt;
    std::uint32_t packed = 0;
    for (int i = 3; i >= 0; --i)
        packed = packed << 8 | bytes[std::size_t(i)];
    return time_code_from_packed(packed, rate);
}

/// The frame's place in a shot. All of it is in IFD0.
void read_place(const TiffTags& camera, Shot& shot)
{
    shot.frame_rate = read_frame_rate(camera);
    shot.time_code = read_time_code(camera, shot.frame_rate);
    shot.reel_name = camera.text(tag::reel_name);
    shot.camera_label = camera.text(tag::camera_label);
}

} // namespace

std::optional<std::array<double, 2>> read_default_scale(const TiffTags& image)
{
    const auto horizontal = image.positive(tag::default_scale);
    const auto vertical = image.positive(tag::default_scale, 1);
    if (!horizontal || !vertical)
        return std::nullopt;
    return { { *horizontal, *vertical } };
}

void read_dng_names(const TiffTags& camera, const TiffTags& exif, DngMetadata& metadata)
{
    metadata.make = camera.text(tag::make);
    metadata.model = camera.text(tag::model);
    metadata.unique_camera_model = camera.text(tag::unique_camera_model);
    if (metadata.unique_camera_model.empty() && metadata.model.empty())
        camera.fail(tag::unique_camera_model,
                    "and " + text_of(tag::model)
                        + " are missing or empty; one must name the camera: use"
                          " another DNG of this camera");
    metadata.baseline_exposure = camera.finite(tag::baseline_exposure);
    Shot& shot = metadata.shot;
    shot.exposure_time = exif.positive(tag::exposure_time);
    shot.f_number = exif.positive(tag::f_number);
    shot.focal_length = exif.positive(tag::focal_length);
    shot.iso = read_iso(exif);
    shot.exposure_bias = exif.finite(tag::exposure_bias_value);
    shot.brightness = exif.finite(tag::brightness_value);
    shot.exposure_mode = exposure_mode_from_number(exif.finite(tag::exposure_mode));
    shot.date_time_original = exif.text(tag::date_time_original);
    shot.artist = camera.text(tag::artist);
    shot.copyright = camera.text(tag::copyright);
    shot.description = camera.text(tag::image_description);
    shot.lens_model = exif.text(tag::lens_model);
    // DNG's 9 is unknown, as is whatever Exif does not define.
    const double orientation = camera.positive(tag::orientation).value_or(1.0);
    const bool known = orientation <= 8.0 && orientation == std::floor(orientation);
    shot.orientation = known ? int(orientation) : 1;
    if (const auto scale = read_default_scale(camera))
        shot.pixel_aspect = (*scale)[0] / (*scale)[1];
    read_place(camera, shot);
    shot = plausible(shot);
}

} // namespace cg2raw

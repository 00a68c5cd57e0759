// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What the camera is called, and what Exif says of the shot.
#include "exif_date.h"
#include "reader/metadata_parts.h"

#include <cmath>

namespace cg2raw {
namespace {

constexpr Bounds iso_count { 1, 16 };
/// ISOSpeedRatings is 16 bits wide and says 65535 for more; the others hold the number.
constexpr std::int64_t iso_elsewhere = 65535;
constexpr Bounds iso_bounds { 0, 10000000 };

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

/// Exif says unknown by 0 or by a denominator of 0; what no shot can have is unknown
/// too.
std::optional<double> plausible(const TiffTags& exif, TiffTag tag)
{
    const auto value = exif.positive(tag);
    return value && *value >= 1e-9 && *value <= 1e6 ? value : std::nullopt;
}

} // namespace

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
    Shot& shot = metadata.shot;
    shot.exposure_time = plausible(exif, tag::exposure_time);
    shot.f_number = plausible(exif, tag::f_number);
    shot.focal_length = plausible(exif, tag::focal_length);
    shot.iso = read_iso(exif);
    const std::string date = exif.text(tag::date_time_original);
    shot.date_time_original = is_exif_date(date) ? date : "";
    shot.artist = camera.text(tag::artist);
    shot.copyright = camera.text(tag::copyright);
    shot.description = camera.text(tag::image_description);
    shot.lens_model = exif.text(tag::lens_model);
    // DNG's 9 is unknown, as is whatever Exif does not define.
    const double orientation = camera.positive(tag::orientation).value_or(1.0);
    const bool known = orientation <= 8.0 && orientation == std::floor(orientation);
    shot.orientation = known ? int(orientation) : 1;
}

} // namespace cg2raw

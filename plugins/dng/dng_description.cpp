// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "cg2raw/dng_description.h"

#include "exif_date.h"

#include <cmath>

namespace cg2raw {
namespace {

/// Exif is a rational number of 32 bits: what it can hold, and what makes sense.
constexpr double least_of_exif = 1e-6, most_of_exif = 1e6;

std::optional<double> within_exif(const std::optional<double>& value)
{
    // What OpenImageIO read was a float: the bounds are floats too.
    const bool fits = value && *value >= double(float(least_of_exif))
        && *value <= double(float(most_of_exif));
    return fits ? value : std::nullopt;
}

} // namespace

std::optional<ExposureMode>
exposure_mode_from_number(const std::optional<double>& number)
{
    for (const ExposureMode mode :
         { ExposureMode::automatic, ExposureMode::manual, ExposureMode::bracket })
        if (number && *number == double(mode))
            return mode;
    return std::nullopt;
}

Shot plausible(Shot shot)
{
    shot.exposure_time = within_exif(shot.exposure_time);
    shot.f_number = within_exif(shot.f_number);
    shot.focal_length = within_exif(shot.focal_length);
    for (std::optional<double>* stops : { &shot.exposure_bias, &shot.brightness })
        if (*stops && !(std::abs(**stops) <= most_exif_stops))
            stops->reset();
    if (const auto aspect = shot.pixel_aspect;
        aspect && !(*aspect >= least_pixel_aspect && *aspect <= most_pixel_aspect))
        shot.pixel_aspect.reset();
    if (!is_exif_date(shot.date_time_original))
        shot.date_time_original.clear();
    if (shot.orientation < 1 || shot.orientation > 8)
        shot.orientation = 1;
    if (shot.frame_rate && !has_time_codes(*shot.frame_rate))
        shot.time_code.reset();
    return shot;
}

} // namespace cg2raw

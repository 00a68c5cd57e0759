// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What a file takes over from the image, and from a reference DNG.
#include "dng_reader_tags.h"

#include <algorithm>
#include <cctype>

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

bool same_but_for_case(const std::string& a, const std::string& b)
{
    const auto lower
        = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [&](char x, char y) { return lower(x) == lower(y); });
}

} // namespace

Shot plausible(Shot shot)
{
    shot.exposure_time = within_exif(shot.exposure_time);
    shot.f_number = within_exif(shot.f_number);
    shot.focal_length = within_exif(shot.focal_length);
    if (!is_exif_date(shot.date_time_original))
        shot.date_time_original.clear();
    if (shot.orientation < 1 || shot.orientation > 8)
        shot.orientation = 1;
    return shot;
}

Shot merged(Shot reference, const Shot& image)
{
    reference.orientation = image.orientation;
    if (!reference.exposure_time)
        reference.exposure_time = image.exposure_time;
    if (!reference.f_number)
        reference.f_number = image.f_number;
    if (!reference.focal_length)
        reference.focal_length = image.focal_length;
    reference.artist = image.artist;
    reference.copyright = image.copyright;
    reference.description = image.description;
    for (auto text : { &Shot::date_time_original, &Shot::lens_model })
        if ((reference.*text).empty())
            reference.*text = image.*text;
    return reference;
}

SensorProfile with_measurements(SensorProfile reference, const SensorProfile& measured,
                                const std::string& file)
{
    if (!same_but_for_case(reference.unique_camera_model, measured.unique_camera_model)
        && !same_but_for_case(reference.model, measured.model))
        throw Error("reference " + file + " is of a \"" + reference.unique_camera_model
                    + "\", sensor " + measured.id + " is a \""
                    + measured.unique_camera_model
                    + "\": give only one of them, or a pair of the same camera");
    reference.id = measured.id;
    reference.illuminants = measured.illuminants;
    reference.digital_gain = measured.digital_gain;
    reference.effects = measured.effects;
    if (!measured.noise.empty())
        reference.noise = measured.noise;
    reference.noise_effects = measured.noise_effects;
    check(reference, file);
    return reference;
}

} // namespace cg2raw

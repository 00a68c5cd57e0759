// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What a file takes over from the image, and from a reference DNG.
#include "cg2raw/dng_reader.h"

#include <algorithm>
#include <cctype>

namespace cg2raw {
namespace {

bool same_but_for_case(const std::string& a, const std::string& b)
{
    const auto lower
        = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [&](char x, char y) { return lower(x) == lower(y); });
}

} // namespace

Shot merged(Shot reference, const Shot& image)
{
    reference.orientation = image.orientation;
    if (image.pixel_aspect)
        reference.pixel_aspect = image.pixel_aspect;
    for (auto number : { &Shot::exposure_time, &Shot::f_number, &Shot::exposure_bias,
                         &Shot::brightness, &Shot::focal_length })
        if (!(reference.*number))
            reference.*number = image.*number;
    if (!reference.exposure_mode)
        reference.exposure_mode = image.exposure_mode;
    reference.artist = image.artist;
    reference.copyright = image.copyright;
    reference.description = image.description;
    reference.frame_rate = image.frame_rate;
    reference.time_code = image.time_code;
    reference.reel_name = image.reel_name;
    reference.camera_label = image.camera_label;
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
    reference.lamps = measured.lamps;
    reference.spectral_sensitivities = measured.spectral_sensitivities;
    reference.digital_gain = measured.digital_gain;
    reference.base_iso = measured.base_iso;
    reference.effects = measured.effects;
    if (!measured.noise.empty())
        reference.noise = measured.noise;
    reference.noise_effects = measured.noise_effects;
    check(reference, file);
    return reference;
}

} // namespace cg2raw

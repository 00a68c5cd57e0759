// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/transform.h"

#include "illuminant_spec.h"
#include "illuminant_spectrum.h"
#include "text.h"
#include "transform_uplift.h"

#include <algorithm>
#include <cmath>

namespace cg2raw {
namespace {

/// XYZ -> linear sRGB as the paper's reference implementation has it (B. Lindbloom),
/// before its rows are normalised.
constexpr Mat3 paper_srgb_from_xyz { { 3.2404542, -1.5371385, -0.4985314, -0.9692660,
                                       1.8760108, 0.0415560, 0.0556434, -0.2040259,
                                       1.0572252 } };
/// Temperatures between which the paper's reference implementation interpolates, K.
constexpr double paper_warm = 2500.0, paper_cool = 6500.0;
constexpr double paper_close_enough = 1e-4;
constexpr int paper_most_passes = 1000;

/// The row-normalised matrices of the paper; the same twice if there is but one.
std::array<Mat3, 2> paper_warm_and_cool(const SensorProfile& profile)
{
    const auto [warm, cool] = warm_and_cool(profile);
    return { row_normalised(profile.calibrations[warm].camera_from_xyz),
             row_normalised(profile.calibrations[cool].camera_from_xyz) };
}

double paper_cool_weight(double cct)
{
    return (1.0 / cct - 1.0 / paper_warm) / (1.0 / paper_cool - 1.0 / paper_warm);
}

Mat3 paper_camera_from_xyz(const SensorProfile& profile, double cct)
{
    const auto [warm, cool] = paper_warm_and_cool(profile);
    const double w = paper_cool_weight(cct);
    Mat3 result {};
    for (std::size_t i = 0; i < 9; ++i)
        result.m[i]
            = std::max(w, 0.0) * cool.m[i] + std::clamp(1.0 - w, 0.0, 1.0) * warm.m[i];
    return row_normalised(result);
}

Mat3 balanced_from_srgb(const SensorProfile& profile, const Illuminant& light)
{
    const Mat3 xyz_d50 = xyz_d50_from_srgb();
    if (const auto xyz_d50_from_balanced = xyz_d50_from_camera(profile, light.xy)) {
        // A renderer scales the rows so that balanced white is exactly D50.
        const Vec3 white = *xyz_d50_from_balanced * Vec3 { 1, 1, 1 };
        const Vec3 d50 = xyz_from_xy(d50_white);
        const Vec3 scale { d50[0] / white[0], d50[1] / white[1], d50[2] / white[2] };
        return inverse(diagonal(scale) * *xyz_d50_from_balanced) * xyz_d50;
    }
    const Mat3 camera
        = camera_from_xyz(profile, light.xy) * bradford(light.xy, d50_white) * xyz_d50;
    return row_normalised(camera);
}

/// Luminance of the scene in all three planes: white is 1. Source: IEC 61966-2-1.
CameraTransform mono_transform()
{
    const Mat3 xyz = xyz_d65_from_srgb();
    const double white = xyz(1, 0) + xyz(1, 1) + xyz(1, 2);
    CameraTransform transform {};
    for (int row = 0; row < 3; ++row)
        for (int col = 0; col < 3; ++col)
            transform.first(row, col) = xyz(1, col) / white;
    transform.second = diagonal({ 1, 1, 1 });
    transform.gains = { 1, 1, 1 };
    return transform;
}

CameraTransform dng_transform(const SensorProfile& profile, const Illuminant& light)
{
    CameraTransform transform {};
    transform.first = balanced_from_srgb(profile, light);
    transform.second = diagonal({ 1, 1, 1 });
    const double largest = max_of(light.neutral);
    for (std::size_t i = 0; i < 3; ++i)
        transform.gains[i] = light.neutral[i] / largest;
    return transform;
}

CameraTransform spectral_transform(const SensorProfile& profile,
                                   const Illuminant& light)
{
    CameraTransform transform
        = profile.cfa.is_mono() ? mono_transform() : dng_transform(profile, light);
    const auto [power, name] = spectrum_of(profile, light);
    transform.uplift = balanced_from_terms(*profile.spectral_sensitivities, power);
    transform.spectrum = name;
    return transform;
}

CameraTransform paper_transform(const SensorProfile& profile, const Illuminant& light)
{
    if (profile.cfa.is_mono())
        throw Error(
            "convention paper: sensor " + profile.id
            + " is monochrome, and the paper's method is for colours: say dng or "
              "sensor");
    const double cct = paper_temperature(profile, light.neutral).cct.value;
    CameraTransform transform {};
    transform.first = inverse(row_normalised(paper_srgb_from_xyz));
    transform.two_steps = true;
    transform.second = paper_camera_from_xyz(profile, cct);
    transform.gains = { light.neutral[0], light.neutral[1], light.neutral[2] };
    transform.clip_result = true;
    return transform;
}

} // namespace

Convention convention_from_name(std::string_view name)
{
    const std::string word = lower_case(name);
    if (word == "dng")
        return Convention::dng;
    if (word == "paper")
        return Convention::paper;
    if (word == "sensor")
        return Convention::sensor;
    if (word == "spectral")
        return Convention::spectral;
    throw Error("convention \"" + std::string(name)
                + "\" must be dng, paper, sensor or spectral");
}

const char* name_of(Convention convention)
{
    constexpr const char* names[] = { "dng", "paper", "sensor", "spectral" };
    return names[std::size_t(convention)];
}

Temperature paper_temperature(const SensorProfile& profile, const Vec3& neutral)
{
    const auto [warm, cool] = paper_warm_and_cool(profile);
    Vec3 xyz { 0.3, 0.3, 0.3 };
    Temperature temperature {};
    for (int pass = 0; pass < paper_most_passes; ++pass) {
        temperature = temperature_from_xy(xy_from_xyz(xyz), RobertsonTable::corrected);
        const Mat3 m = mixed(warm, cool, paper_cool_weight(temperature.cct.value));
        const Vec3 next = inverse(m) * neutral;
        const double step
            = std::hypot(next[0] - xyz[0], next[1] - xyz[1], next[2] - xyz[2]);
        xyz = next;
        if (step <= paper_close_enough)
            break;
    }
    return temperature;
}

CameraTransform camera_from_scene(const SensorProfile& profile, const Illuminant& light,
                                  Convention convention, double digital_gain,
                                  bool keep_highlights)
{
    const SensorProfile calibrated = calibrated_for(profile, light.spec);
    if (!(digital_gain > 0.0 && digital_gain <= 1000.0))
        throw Error("digital gain " + number(digital_gain)
                    + " must be above 0 and at most 1000");
    CameraTransform transform = convention == Convention::paper
        ? paper_transform(calibrated, light)
        : convention == Convention::spectral ? spectral_transform(calibrated, light)
        : profile.cfa.is_mono()              ? mono_transform()
                                             : dng_transform(calibrated, light);
    transform.is_grey = profile.cfa.is_mono();
    for (double& gain : transform.gains)
        gain *= digital_gain;
    transform.is_light
        = convention == Convention::sensor || convention == Convention::spectral;
    transform.keep_highlights = keep_highlights && !transform.is_light;
    return transform;
}

SceneTransform scene_from_camera(const CameraTransform& camera_from_scene)
{
    const auto& [first, two_steps, second, gains, keep, clip, light, grey, exposure,
                 uplift, spectrum]
        = camera_from_scene;
    if (uplift)
        throw Error("convention spectral has no inverse: many spectra are one colour; "
                    "say dng");
    if (grey)
        return { gains, diagonal({ 1, 1, 1 }), false, diagonal({ 1, 1, 1 }) };
    if (two_steps)
        return { gains, inverse(second), true, inverse(first) };
    return { gains, diagonal({ 1, 1, 1 }), false, inverse(second * first) };
}

Mat3 srgb_from_balanced(const SensorProfile& profile, const Illuminant& light)
{
    if (profile.cfa.is_mono())
        return diagonal({ 1, 1, 1 });
    return inverse(balanced_from_srgb(calibrated_for(profile, light.spec), light));
}

} // namespace cg2raw

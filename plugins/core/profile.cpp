// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/profile.h"

#include "cfa.h"
#include "neutral_distribution.h"
#include "noise_table.h"
#include "profile_json.h"
#include "profile_lamps.h"
#include "text.h"

#include <algorithm>
#include <cmath>

namespace cg2raw {
namespace {

struct LightSource {
    int code;
    const char* name;
    double kelvin;
};

/// EXIF 2.32 LightSource codes, with the temperatures that raw converters give them.
/// Source: DNG specification 1.7, CalibrationIlluminant1; temperatures as Adobe's.
constexpr LightSource light_sources[] = {
    { 17, "A", 2850 },
    { 18, "B", 5500 },
    { 19, "C", 6500 },
    { 20, "D55", 5500 },
    { 21, "D65", 6500 },
    { 22, "D75", 7500 },
    { 23, "D50", 5000 },
    { 24, "ISO studio tungsten", 3200 },
    { 1, "daylight", 5500 },
    { 2, "fluorescent", 4150 },
    { 3, "tungsten", 2850 },
    { 4, "flash", 5500 },
    { 9, "fine weather", 5500 },
    { 10, "cloudy weather", 6500 },
    { 11, "shade", 7500 },
    { 12, "daylight fluorescent", 6400 },
    { 13, "day white fluorescent", 5050 },
    { 14, "cool white fluorescent", 4150 },
    { 15, "white fluorescent", 3525 },
};

[[noreturn]] void fail(const std::string& file, const std::string& what)
{
    throw Error(file + ": " + what);
}

void check_levels(const SensorProfile& profile, const std::string& file)
{
    const int top = (1 << profile.bits) - 1;
    if (profile.white_level > top)
        fail(file,
             "white_level " + std::to_string(profile.white_level) + " DN must be 1 to "
                 + std::to_string(top) + " DN, the most of "
                 + std::to_string(profile.bits) + " bits");
    if (profile.black_level.size() != std::size_t(profile.cfa.sites()))
        fail(file,
             "black_level has " + std::to_string(profile.black_level.size())
                 + " values; it needs " + std::to_string(profile.cfa.sites())
                 + ", one per CFA site");
    for (double black : profile.black_level)
        if (!(black >= 0.0 && black < profile.white_level))
            fail(file,
                 "black_level " + number(black)
                     + " DN must be at least 0 and below white_level "
                     + std::to_string(profile.white_level) + " DN");
}

/// What the sum of a row may be off by: the sum of three rounded values, each by half
/// of 1 / @p denominator at most, and D50 itself, of which makers publish three or four
/// decimals that differ.
double white_tolerance(double denominator)
{
    constexpr double of_d50 = 0.001;
    return of_d50 + 3.0 * 0.5 / std::max(denominator, coarsest_denominator);
}

/// Balanced white must be that of the profile connection space.
void check_forward_matrix(const Calibration& calibration, const std::string& file,
                          const std::string& index)
{
    if (!calibration.xyz_d50_from_camera)
        return;
    const std::string field = "forward_matrix_" + index;
    try {
        inverse(*calibration.xyz_d50_from_camera);
    } catch (const Error& error) {
        fail(file, field + ": " + error.what());
    }
    if (!maps_white_to_d50(*calibration.xyz_d50_from_camera))
        fail(file,
             field + " " + white_text(*calibration.xyz_d50_from_camera)
                 + ": scale each of its rows to that sum, or leave the matrix out");
}

/// A monochrome sensor tells no colours apart.
void check_mono(const SensorProfile& profile, const std::string& file)
{
    if (!profile.calibrations.empty())
        fail(file, "cfa mono needs no colour matrix: leave it out");
    const NeutralDistribution& lights = profile.illuminants;
    if (!profile.lamps.empty())
        fail(file, "cfa mono sees all lamps alike: leave lamps out");
    if (!lights.neutrals.empty() || !lights.hull.empty())
        fail(file, "cfa mono has no neutrals: leave illuminants out");
}

/// A matrix has an inverse, and each channel sees white.
void check_color_matrix(const Mat3& camera_from_xyz, const std::string& field,
                        const std::string& file)
{
    try {
        inverse(camera_from_xyz);
    } catch (const Error& error) {
        fail(file, field + ": " + error.what());
    }
    for (double channel : camera_from_xyz* xyz_from_xy(d50_white))
        if (!(channel > 0.0))
            fail(file,
                 field + " maps white to " + number(channel)
                     + "; each channel must see white (more than 0)");
}

void check_calibrations(const SensorProfile& profile, const std::string& file)
{
    if (profile.calibrations.empty() || profile.calibrations.size() > 2)
        fail(file, "needs one or two colour matrices");
    for (std::size_t i = 0; i < profile.calibrations.size(); ++i) {
        const std::string field = "color_matrix_" + std::to_string(i + 1);
        const Calibration& calibration = profile.calibrations[i];
        check_color_matrix(calibration.camera_from_xyz, field, file);
        try {
            light_source_temperature(calibration.light_source);
        } catch (const Error& error) {
            fail(file, field + ": " + error.what());
        }
        check_forward_matrix(calibration, file, std::to_string(i + 1));
    }
    if (profile.calibrations.size() == 2
        && light_source_temperature(profile.calibrations[0].light_source).value
            == light_source_temperature(profile.calibrations[1].light_source).value)
        fail(file, "calibration_illuminant_1 and _2 must differ in temperature");
}

} // namespace

Kelvin light_source_temperature(int light_source)
{
    for (const LightSource& light : light_sources)
        if (light.code == light_source)
            return { light.kelvin };
    throw Error("calibration illuminant " + std::to_string(light_source)
                + " is no EXIF LightSource with a temperature");
}

std::vector<std::string> light_source_names()
{
    std::vector<std::string> names;
    for (const LightSource& light : light_sources)
        names.emplace_back(light.name);
    return names;
}

int light_source_from_name(std::string_view name)
{
    for (const LightSource& light : light_sources)
        if (lower_case(light.name) == lower_case(name))
            return light.code;
    throw Error("calibration illuminant \"" + std::string(name) + "\" must be one of "
                + joined(light_source_names()));
}

std::string light_source_name(int light_source)
{
    for (const LightSource& light : light_sources)
        if (light.code == light_source)
            return light.name;
    if (light_source == other_light_source)
        return "other";
    return std::to_string(light_source);
}

bool maps_white_to_d50(const Mat3& xyz_d50_from_camera, double denominator)
{
    const double tolerance = white_tolerance(denominator);
    const Vec3 white = xyz_d50_from_camera * Vec3 { 1, 1, 1 };
    const Vec3 d50 = xyz_from_xy(d50_white);
    for (std::size_t i = 0; i < 3; ++i)
        if (!(std::abs(white[i] - d50[i]) <= tolerance))
            return false;
    return true;
}

std::string white_text(const Mat3& xyz_d50_from_camera, double denominator)
{
    const auto text = [](const Vec3& xyz) {
        std::string words;
        for (const double value : xyz) // four decimals, as matrices have
            words += " " + number(std::round(1e4 * value) / 1e4);
        return words;
    };
    return "maps white to XYZ" + text(xyz_d50_from_camera * Vec3 { 1, 1, 1 })
        + "; it must be that of D50," + text(xyz_from_xy(d50_white)) + ", within "
        + number(std::round(1e5 * white_tolerance(denominator)) / 1e5);
}

void check(const SensorProfile& profile, const std::string& file)
{
    check_fields(profile, file);
    try {
        check_cfa(profile.cfa);
    } catch (const Error& error) {
        fail(file, error.what());
    }
    check_levels(profile, file);
    if (profile.cfa.is_mono())
        check_mono(profile, file);
    else
        check_calibrations(profile, file);
    for (const Lamp& lamp : profile.lamps)
        check_color_matrix(lamp.calibration.camera_from_xyz, "lamp " + lamp.name, file);
    check_lamps(profile.lamps, file);
    if (profile.spectral_sensitivities)
        check(*profile.spectral_sensitivities, file);
    check_noise(profile, file);
    check_neutrals(profile, file);
    if (profile.digital_gain
        && !(profile.digital_gain->mean > 0.0 && profile.digital_gain->sigma >= 0.0))
        fail(file, "digital_gain needs mean above 0 and sigma of at least 0");
}

} // namespace cg2raw

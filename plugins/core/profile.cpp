// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/profile.h"

#include "cfa.h"
#include "noise_table.h"
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

/// A draw is compared with each side. Neutrals by the million have a hull of some
/// hundred.
constexpr std::size_t most_hull_points = 1000;

double cross(const std::array<double, 2>& o, const std::array<double, 2>& a,
             const std::array<double, 2>& b)
{
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
}

/// Half a hull: the left turns of points in order (monotone chain).
void append_chain(const std::vector<std::array<double, 2>>& points,
                  std::vector<std::array<double, 2>>& hull)
{
    const std::size_t start = hull.size();
    for (const auto& point : points) {
        while (hull.size() >= start + 2
               && cross(hull[hull.size() - 2], hull.back(), point) <= 0)
            hull.pop_back();
        hull.push_back(point);
    }
    hull.pop_back();
}

std::vector<std::array<double, 2>>
convex_hull(std::vector<std::array<double, 2>> points)
{
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    if (points.size() < 3)
        return {};
    std::vector<std::array<double, 2>> hull;
    append_chain(points, hull);
    std::reverse(points.begin(), points.end());
    append_chain(points, hull);
    return hull.size() < 3 ? std::vector<std::array<double, 2>> {} : hull;
}

[[noreturn]] void fail(const std::string& file, const std::string& what)
{
    throw Error(file + ": " + what);
}

void check_levels(const SensorProfile& profile, const std::string& file)
{
    if (profile.bits < 8 || profile.bits > 16)
        fail(file, "bits " + std::to_string(profile.bits) + " must be 8 to 16");
    const int top = (1 << profile.bits) - 1;
    if (profile.white_level < 1 || profile.white_level > top)
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

/// Balanced white must be a light: each of its XYZ above 0.
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
    for (double value : *calibration.xyz_d50_from_camera* Vec3 { 1, 1, 1 })
        if (!(value > 0.0))
            fail(file,
                 field + " maps white to an XYZ of " + number(value)
                     + "; each must be above 0");
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

/// What a distribution without its neutrals says must be of one set of neutrals: their
/// mean is in their hull, and no variance is above its range squared. Else no draw of
/// the one would fall into the other.
void check_distribution(const NeutralDistribution& lights, const std::string& file)
{
    if (!lights.neutrals.empty() || lights.hull.empty())
        return;
    for (std::size_t i = 0; i < lights.hull.size(); ++i)
        if (cross(lights.hull[i], lights.hull[(i + 1) % lights.hull.size()],
                  lights.mean)
            < 0.0)
            fail(file,
                 "illuminants: mean " + number(lights.mean[0]) + ", "
                     + number(lights.mean[1])
                     + " must lie in the hull, as that of neutrals does");
    for (std::size_t i : { 0, 1 }) {
        const auto [low, high] = std::minmax_element(
            lights.hull.begin(), lights.hull.end(),
            [&](const auto& a, const auto& b) { return a[i] < b[i]; });
        const double range = (*high)[i] - (*low)[i],
                     variance = lights.covariance[2 * i];
        if (!(variance <= range * range))
            fail(file,
                 "illuminants: variance " + number(variance) + " must be at most "
                     + number(range * range) + ", the square of the hull's range");
    }
}

void check_neutrals(const SensorProfile& profile, const std::string& file)
{
    const NeutralDistribution& lights = profile.illuminants;
    const auto check_pair = [&](const char* what, const std::array<double, 2>& pair) {
        for (double ratio : pair)
            if (!(ratio >= 0.01 && ratio <= 100.0))
                fail(file,
                     "illuminants: " + std::string(what) + " " + number(ratio)
                         + " must be within 0.01 to 100 (R/G and B/G)");
    };
    for (const auto& neutral : lights.neutrals)
        check_pair("neutral", neutral);
    for (const auto& corner : lights.hull)
        check_pair("hull", corner);
    if (!lights.hull.empty())
        check_pair("mean", lights.mean);
    check_distribution(lights, file);
    if (lights.hull.size() > most_hull_points)
        fail(file,
             "illuminants: hull has " + std::to_string(lights.hull.size())
                 + " corners; at most " + std::to_string(most_hull_points)
                 + ": give a coarser one");
    for (const Lamp& lamp : profile.lamps)
        check_pair(("lamp " + lamp.name).c_str(), lamp.neutral);
    const auto& [rr, rb, bb] = lights.covariance;
    if (!(rr >= 0.0 && bb >= 0.0 && rb * rb <= rr * bb * (1 + 1e-9) + 1e-30))
        fail(file, "illuminants: covariance must be positive semi-definite");
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

int light_source_from_name(std::string_view name)
{
    std::vector<std::string> names;
    for (const LightSource& light : light_sources) {
        if (lower_case(light.name) == lower_case(name))
            return light.code;
        names.emplace_back(light.name);
    }
    throw Error("calibration illuminant \"" + std::string(name) + "\" must be one of "
                + joined(names));
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

NeutralDistribution distribution_of(std::vector<std::array<double, 2>> neutrals)
{
    NeutralDistribution result;
    const double count = double(neutrals.size());
    for (const auto& neutral : neutrals)
        for (std::size_t i = 0; i < 2; ++i)
            result.mean[i] += neutral[i] / count;
    for (const auto& neutral : neutrals) {
        const double r = neutral[0] - result.mean[0], b = neutral[1] - result.mean[1];
        if (count > 1) {
            result.covariance[0] += r * r / (count - 1);
            result.covariance[1] += r * b / (count - 1);
            result.covariance[2] += b * b / (count - 1);
        }
    }
    result.hull = convex_hull(neutrals);
    result.neutrals = std::move(neutrals);
    return result;
}

void check(const SensorProfile& profile, const std::string& file)
{
    if (profile.width < 2 || profile.height < 2 || profile.width > 65535
        || profile.height > 65535)
        fail(file,
             "width and height " + std::to_string(profile.width) + " x "
                 + std::to_string(profile.height) + " must be 2 to 65535 pixels");
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

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/illuminant.h"

#include "illuminant_spec.h"
#include "illuminant_spectrum.h"
#include "text.h"

#include <algorithm>
#include <cmath>

namespace cg2raw {
namespace {

/// Passes after which a raw converter gives up and averages. Source: the iteration
/// that chapter 6 of the DNG specification describes.
constexpr int most_passes = 30;
constexpr double close_enough = 1e-7;

double rounded(double value, double steps) { return std::round(value * steps) / steps; }

/// As raw converters take a ColorMatrix in: the largest channel of D50 near 1, rounded.
Mat3 as_converters_read(Mat3 camera_from_xyz)
{
    const double largest = max_of(camera_from_xyz * xyz_from_xy(d50_white));
    const bool near_one = largest >= 0.99 && largest <= 1.01;
    for (double& value : camera_from_xyz.m)
        value = rounded(near_one ? value : value / largest, 10000.0);
    return camera_from_xyz;
}

[[noreturn]] void fail_unknown_lamp(const SensorProfile& profile,
                                    const std::string& name)
{
    std::vector<std::string> known;
    for (const Lamp& lamp : profile.lamps)
        known.push_back(lamp.name);
    throw Error("sensor " + profile.id + " has no matrix for lamp \"" + name + "\": "
                + (known.empty() ? "its profile lists no lamp"
                                 : "its lamps are " + joined(known))
                + "; cg2raw profile --ssf FILE --illuminant-spd LAMP makes a profile "
                  "that has it");
}

/// What sensitivities see of a lamp that the profile has no matrix for.
Vec3 lamp_seen(const SensorProfile& profile, const std::string& name)
{
    const auto lamp = lamp_spectrum(name);
    if (!lamp || !profile.spectral_sensitivities)
        fail_unknown_lamp(profile, name);
    return response(*profile.spectral_sensitivities, lamp->power);
}

Vec3 neutral_of(const SensorProfile& profile, const IlluminantSpec& spec,
                const std::optional<Vec3>& as_shot)
{
    using Kind = IlluminantSpec::Kind;
    switch (spec.kind) {
    case Kind::xy:
        return neutral_from_xy(profile, { spec.a, spec.b });
    case Kind::kelvin:
        return neutral_from_xy(profile, planckian_xy({ spec.a }));
    case Kind::neutral:
        return over_green({ spec.a, 1.0, spec.b });
    case Kind::sample: {
        const auto sample = sampled_neutral(profile, spec.index);
        return over_green({ sample[0], 1.0, sample[1] });
    }
    case Kind::measured: {
        const auto drawn = measured_neutral(profile, spec.index);
        return over_green({ drawn[0], 1.0, drawn[1] });
    }
    case Kind::lamp:
        return over_green(lamp_seen(profile, spec.name));
    case Kind::as_shot:
        break;
    }
    if (!as_shot)
        throw Error("illuminant \"as-shot\" needs a reference DNG (dng:reference) that "
                    "holds an AsShotNeutral");
    for (double channel : *as_shot)
        if (!(channel >= 0.001 && channel <= 1000.0))
            throw Error("as-shot neutral " + number(channel)
                        + " must be 0.001 to 1000");
    return over_green(*as_shot);
}

/// What a monochrome sensor sees of a light is 1, whatever the light: white of the
/// scene is. The words of a light say which it was, and no word is needed.
Illuminant mono_illuminant(const SensorProfile& profile, std::string_view spec)
{
    using Kind = IlluminantSpec::Kind;
    constexpr Chromaticity scene_white { 0.3127, 0.3290 }; // D65, of Rec.709
    Chromaticity xy = scene_white;
    if (!spec.empty()) {
        const IlluminantSpec light = parse_illuminant(spec);
        if (light.kind == Kind::xy)
            xy = { light.a, light.b };
        else if (light.kind == Kind::kelvin)
            xy = planckian_xy({ light.a });
        else if (light.kind == Kind::sample || light.kind == Kind::measured
                 || (light.kind == Kind::neutral && (light.a != 1.0 || light.b != 1.0)))
            throw Error("illuminant \"" + std::string(spec) + "\": sensor " + profile.id
                        + " is monochrome and has no neutrals: name a light such as "
                          "D65, or leave the illuminant out");
    }
    return { std::string(spec),
             profile.id,
             { 1, 1, 1 },
             xy,
             temperature_from_xy(xy, RobertsonTable::adobe) };
}

} // namespace

Vec3 over_green(const Vec3& camera)
{
    return { rounded(camera[0] / camera[1], 1e6), 1.0,
             rounded(camera[2] / camera[1], 1e6) };
}

std::array<std::size_t, 2> warm_and_cool(const SensorProfile& profile)
{
    const auto& all = profile.calibrations;
    if (all.empty())
        throw Error("sensor " + profile.id
                    + " is monochrome and has no colour matrix: what needs one is for "
                      "sensors with a colour filter array");
    if (all.size() < 2)
        return { 0, 0 };
    const bool ordered = light_source_temperature(all[0].light_source).value
        <= light_source_temperature(all[1].light_source).value;
    return ordered ? std::array<std::size_t, 2> { 0, 1 }
                   : std::array<std::size_t, 2> { 1, 0 };
}

double warm_weight(const SensorProfile& profile, Chromaticity xy)
{
    const auto [warm, cool] = warm_and_cool(profile);
    if (warm == cool)
        return 1.0;
    const auto kelvin = [&](std::size_t i) {
        return light_source_temperature(profile.calibrations[i].light_source).value;
    };
    const double t_warm = kelvin(warm), t_cool = kelvin(cool);
    const double t = temperature_from_xy(xy, RobertsonTable::adobe).cct.value;
    if (t <= t_warm)
        return 1.0;
    if (t >= t_cool)
        return 0.0;
    return (1.0 / t - 1.0 / t_cool) / (1.0 / t_warm - 1.0 / t_cool);
}

Mat3 camera_from_xyz(const SensorProfile& profile, Chromaticity xy)
{
    const auto [warm, cool] = warm_and_cool(profile);
    const Mat3 m_warm = as_converters_read(profile.calibrations[warm].camera_from_xyz);
    if (warm == cool)
        return m_warm;
    const Mat3 m_cool = as_converters_read(profile.calibrations[cool].camera_from_xyz);
    return mixed(m_cool, m_warm, warm_weight(profile, xy));
}

std::optional<Mat3> xyz_d50_from_camera(const SensorProfile& profile, Chromaticity xy)
{
    const auto [warm, cool] = warm_and_cool(profile);
    const auto& f_warm = profile.calibrations[warm].xyz_d50_from_camera;
    const auto& f_cool = profile.calibrations[cool].xyz_d50_from_camera;
    if (!f_warm || !f_cool)
        return std::nullopt;
    return mixed(*f_cool, *f_warm, warm_weight(profile, xy));
}

NeutralChromaticity xy_from_neutral(const SensorProfile& profile, const Vec3& neutral)
{
    Vec3 largest_one {};
    for (std::size_t i = 0; i < 3; ++i)
        largest_one[i] = rounded(neutral[i] / max_of(neutral), 1e6);
    Chromaticity last = d50_white;
    for (int pass = 1; pass <= most_passes; ++pass) {
        const Mat3 xyz_from_camera = inverse(camera_from_xyz(profile, last));
        Chromaticity next = xy_from_xyz(xyz_from_camera * largest_one);
        if (std::abs(next.x - last.x) + std::abs(next.y - last.y) < close_enough)
            return { next, pass, true };
        if (pass == most_passes)
            next = { (last.x + next.x) / 2, (last.y + next.y) / 2 };
        last = next;
    }
    return { last, most_passes, false };
}

Vec3 neutral_from_xy(const SensorProfile& profile, Chromaticity xy)
{
    const Vec3 camera = camera_from_xyz(profile, xy) * xyz_from_xy(xy);
    for (double channel : camera)
        if (!(channel > 0.0))
            throw Error("sensor " + profile.id + " does not see a light of xy "
                        + number(xy.x) + ", " + number(xy.y)
                        + ": its matrix gives a channel " + number(channel));
    return over_green(camera);
}

SensorProfile calibrated_for(const SensorProfile& profile, std::string_view spec)
{
    SensorProfile result = profile;
    if (const Lamp* const lamp = lamp_named(profile.lamps, spec))
        result.calibrations = { lamp->calibration };
    return result;
}

Illuminant illuminant(const SensorProfile& profile, std::string_view spec,
                      const std::optional<Vec3>& as_shot)
{
    if (profile.cfa.is_mono())
        return mono_illuminant(profile, spec);
    const Lamp* const lamp = lamp_named(profile.lamps, spec);
    const Vec3 neutral = lamp ? over_green({ lamp->neutral[0], 1.0, lamp->neutral[1] })
                              : neutral_of(profile, parse_illuminant(spec), as_shot);
    const Chromaticity xy
        = (lamp ? xy_from_neutral(calibrated_for(profile, spec), neutral)
                : xy_from_neutral(profile, neutral))
              .xy;
    return { std::string(spec), profile.id, neutral, xy,
             temperature_from_xy(xy, RobertsonTable::adobe) };
}

} // namespace cg2raw

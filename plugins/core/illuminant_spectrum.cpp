// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "illuminant_spectrum.h"

#include "illuminant_daylight_tables.h"
#include "illuminant_lamp_tables.h"
#include "illuminant_spec.h"
#include "text.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cg2raw {
namespace {

constexpr double table_step = 5.0; // nm
/// Second radiation constant, m K. Source: CODATA 2018, exact.
constexpr double second_radiation = 1.438776877e-2;
/// That of CIE A is older, so that its table stays. Source: ISO 11664-2.
constexpr double second_radiation_of_a = 1.435e-2;
constexpr double kelvin_of_a = 2848.0;
/// Temperatures are those of an older radiation constant. Source: CIE 015, 4.1.2.
constexpr double daylight_correction = 1.4388 / 1.4380;
/// Where daylight takes over from black bodies. Source: CIE 015, 4.1.2.
constexpr double least_daylight = 4000.0, most_daylight = 25000.0; // K
constexpr double least_black_body = 1667.0; // K, as of the illuminant grammar
constexpr double mired_step = 4.0;
/// Two neutrals whose ratios differ by no more are taken for one light: 2 %.
constexpr double alike = 0.02;

template <std::size_t n> Spectrum spectrum_from(const std::array<double, n>& values)
{
    return { table_wavelengths(), { values.begin(), values.end() } };
}

Spectrum black_body(double kelvin, double radiation = second_radiation)
{
    Spectrum power { table_wavelengths(), {} };
    const auto planck = [&](double nm) {
        return std::pow(nm / 560.0, -5.0)
            / std::expm1(radiation / (nm * 1e-9 * kelvin));
    };
    for (double nm : power.wavelengths)
        power.values.push_back(planck(nm) / planck(560.0));
    return power;
}

/// A phase of daylight. Source: CIE 015, 4.1.2, equations 4.5 to 4.9.
Spectrum daylight(double kelvin)
{
    const double t = 1e3 / kelvin;
    const double x = kelvin <= 7000.0
        ? -4.6070 * t * t * t + 2.9678 * t * t + 0.09911 * t + 0.244063
        : -2.0064 * t * t * t + 1.9018 * t * t + 0.24748 * t + 0.237040;
    const double y = -3.000 * x * x + 2.870 * x - 0.275;
    const double m = 0.0241 + 0.2562 * x - 0.7341 * y;
    const double m1 = (-1.3515 - 1.7703 * x + 5.9114 * y) / m;
    const double m2 = (0.0300 - 31.4424 * x + 30.0717 * y) / m;
    Spectrum power { table_wavelengths(), {} };
    const auto& [s0, s1, s2] = daylight_components;
    for (std::size_t i = 0; i < s0.size(); ++i)
        power.values.push_back((s0[i] + m1 * s1[i] + m2 * s2[i]) / 100.0);
    return power;
}

/// A light, and what the sensor sees of it.
struct Candidate {
    LightSpectrum light;
    Vec3 seen; ///< over green
};

void append(std::vector<Candidate>& all, const SensorProfile& profile, Spectrum power,
            const std::string& name)
{
    Vec3 seen;
    try {
        seen = response(*profile.spectral_sensitivities, power);
    } catch (const Error&) {
        return; // no light for this sensor
    }
    for (double& value : power.values)
        value /= seen[1];
    all.push_back(
        { { std::move(power), name }, { seen[0] / seen[1], 1.0, seen[2] / seen[1] } });
}

/// Black bodies and daylight in steps of colour, then lamps.
std::vector<Candidate> candidates(const SensorProfile& profile)
{
    std::vector<Candidate> all;
    constexpr double warmest = 1e6 / least_black_body, coolest = 1e6 / most_daylight;
    constexpr int steps = int((warmest - coolest) / mired_step);
    for (int step = 0; step <= steps; ++step) {
        const double kelvin = std::round(1e6 / (warmest - mired_step * step));
        const std::string name = number(kelvin) + " K";
        if (kelvin < least_daylight)
            append(all, profile, black_body(kelvin), "black body of " + name);
        else
            append(all, profile, daylight(kelvin * daylight_correction),
                   "daylight of " + name);
    }
    for (std::size_t i = 0; i < lamp_names.size(); ++i)
        append(all, profile, spectrum_from(lamp_powers[i]), lamp_names[i]);
    for (const Lamp& lamp : profile.lamps)
        if (lamp.power)
            append(all, profile, *lamp.power, lamp.name);
    return all;
}

/// How far two neutrals are apart: the root of the squares of their ratios' logarithms.
double apart(const Vec3& a, const Vec3& b)
{
    return std::hypot(std::log(a[0] / b[0]), std::log(a[2] / b[2]));
}

LightSpectrum half_of_each(const LightSpectrum& a, const LightSpectrum& b)
{
    LightSpectrum mixture { { merged(a.power.wavelengths, b.power.wavelengths), {} },
                            "half " + a.name + ", half " + b.name };
    for (double nm : mixture.power.wavelengths)
        mixture.power.values.push_back(a.power.at(nm) + b.power.at(nm));
    return mixture;
}

/// The light whose neutral is nearest; where none is near, the nearest even mixture of
/// two, whose powers are alike as green sees them.
LightSpectrum nearest(const SensorProfile& profile, const Vec3& neutral)
{
    const std::vector<Candidate> all = candidates(profile);
    std::size_t first = 0, second = 0;
    double least = std::numeric_limits<double>::infinity();
    const auto consider = [&](std::size_t i, std::size_t j) {
        Vec3 seen;
        for (std::size_t c = 0; c < 3; ++c)
            seen[c] = 0.5 * (all[i].seen[c] + all[j].seen[c]);
        if (const double distance = apart(seen, neutral); distance < least) {
            least = distance;
            first = i;
            second = j;
        }
    };
    if (all.empty())
        throw Error("sensor " + profile.id
                    + ": its spectral_sensitivities see no light at all");
    for (std::size_t i = 0; i < all.size(); ++i)
        consider(i, i);
    if (least > alike)
        for (std::size_t i = 0; i < all.size(); ++i)
            for (std::size_t j = i + 1; j < all.size(); ++j)
                consider(i, j);
    return first == second ? all[first].light
                           : half_of_each(all[first].light, all[second].light);
}

/// Of the words that are spectra in CIE 015.
std::optional<LightSpectrum> named(const std::string& word)
{
    if (word == "a")
        return LightSpectrum { black_body(kelvin_of_a, second_radiation_of_a), "A" };
    for (const double hundreds : { 50.0, 55.0, 65.0, 75.0 })
        if (word == "d" + number(hundreds))
            return LightSpectrum { daylight(100.0 * hundreds * daylight_correction),
                                   "D" + number(hundreds) };
    return std::nullopt;
}

/// All lights are alike to a monochrome sensor, so that none of them is the nearest.
Error no_spectrum(const SensorProfile& profile)
{
    return Error(
        "sensor " + profile.id
        + " is monochrome, and its neutral tells no spectrum: name the light, as "
          "A, D65, 3200K or FL2");
}

} // namespace

std::vector<double> table_wavelengths()
{
    std::vector<double> nm(lamp_powers[0].size());
    for (std::size_t i = 0; i < nm.size(); ++i)
        nm[i] = visible_from + table_step * double(i);
    return nm;
}

std::optional<LightSpectrum> lamp_spectrum(const std::string& name)
{
    std::string word = lower_case(name);
    std::replace_if(
        word.begin(), word.end(), [](char c) { return c == '_' || c == '.'; }, '-');
    for (std::size_t i = 0; i < lamp_names.size(); ++i)
        if (word == lower_case(lamp_names[i]))
            return LightSpectrum { spectrum_from(lamp_powers[i]), lamp_names[i] };
    return std::nullopt;
}

LightSpectrum spectrum_of(const SensorProfile& profile, const Illuminant& light)
{
    using Kind = IlluminantSpec::Kind;
    if (!profile.spectral_sensitivities)
        throw Error("sensor " + profile.id
                    + " has no spectral_sensitivities: use convention dng, or make a "
                      "profile with cg2raw profile --ssf");
    const Lamp* const lamp = lamp_named(profile.lamps, light.spec);
    if (lamp && lamp->power)
        return { *lamp->power, lamp->name };
    if (const auto found = lamp ? std::nullopt : named(lower_case(light.spec)))
        return *found;
    const bool mono = profile.cfa.is_mono();
    if (mono && light.spec.empty())
        throw no_spectrum(profile);
    const IlluminantSpec spec = lamp
        ? IlluminantSpec { Kind::lamp, 0.0, 0.0, 0, lamp->name }
        : parse_illuminant(light.spec);
    if (spec.kind == Kind::lamp)
        if (const auto found = lamp_spectrum(spec.name))
            return *found;
    if (spec.kind == Kind::kelvin)
        return { black_body(spec.a), "black body of " + number(spec.a) + " K" };
    if (mono)
        throw no_spectrum(profile);
    return nearest(profile, light.neutral);
}

} // namespace cg2raw

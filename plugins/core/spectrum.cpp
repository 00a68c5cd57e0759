// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/spectrum.h"

#include "cg2raw/types.h"
#include "text.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

namespace cg2raw {
namespace {

constexpr double least_peak = 1e-9, most_peak = 1e9;
constexpr double shortest_wavelength = 100.0, longest_wavelength = 5000.0; // nm

[[noreturn]] void fail(const std::string& file, const std::string& what)
{
    throw Error(file + ": spectral_sensitivities: " + what);
}

void check_wavelengths(const std::vector<double>& nm, const std::string& file)
{
    if (nm.size() < 2)
        fail(file, "needs at least two wavelengths");
    for (double wavelength : nm)
        if (!(wavelength >= shortest_wavelength && wavelength <= longest_wavelength))
            fail(file,
                 "wavelength " + number(wavelength) + " must be "
                     + number(shortest_wavelength) + " to " + number(longest_wavelength)
                     + " nm");
    for (std::size_t i = 1; i < nm.size(); ++i) {
        const double step = nm[i] - nm[i - 1];
        if (!(step > 0.0))
            fail(file,
                 "wavelength " + number(nm[i]) + " nm comes after " + number(nm[i - 1])
                     + " nm; they must rise");
        if (step > longest_spectral_step)
            fail(file,
                 "wavelengths have a gap from " + number(nm[i - 1]) + " to "
                     + number(nm[i]) + " nm; at most " + number(longest_spectral_step)
                     + " nm is allowed");
    }
    if (nm.front() > visible_from || nm.back() < visible_to)
        fail(file,
             "wavelengths " + number(nm.front()) + " to " + number(nm.back())
                 + " nm must cover " + number(visible_from) + " to "
                 + number(visible_to) + " nm; state 0 where the sensor sees nothing");
}

void check_channel(const SpectralSensitivities& sensitivities, std::size_t channel,
                   const std::string& file)
{
    const std::string name(1, "RGB"[channel]);
    double lowest = 0.0, peak = 0.0;
    for (const Vec3& values : sensitivities.rgb) {
        if (!std::isfinite(values[channel]))
            fail(file, name + " must be finite");
        lowest = std::min(lowest, values[channel]);
        peak = std::max(peak, values[channel]);
    }
    if (!(peak > 0.0))
        fail(file, name + " is nowhere above 0");
    if (!(peak >= least_peak && peak <= most_peak))
        fail(file,
             name + " has a peak of " + number(peak) + "; it must be "
                 + number(least_peak) + " to " + number(most_peak)
                 + ": divide the curves, and say the divisor as scale");
    if (lowest < -spectral_noise * peak)
        fail(file,
             name + " falls to " + number(lowest) + "; noise may reach "
                 + number(-spectral_noise * peak) + ", 1 % of its peak");
}

/// Index of the wavelength that @p wavelength follows, and its share of the next one.
struct Between {
    std::size_t index;
    double share;
};

/// None outside @p nm, which has two values at least.
std::optional<Between> place(const std::vector<double>& nm, double wavelength)
{
    if (nm.size() < 2 || !(wavelength >= nm.front() && wavelength <= nm.back()))
        return std::nullopt;
    const auto above = std::upper_bound(nm.begin(), nm.end() - 1, wavelength);
    const std::size_t index = std::size_t(above - nm.begin()) - 1;
    return Between { index, (wavelength - nm[index]) / (nm[index + 1] - nm[index]) };
}

/// Gauss and Legendre's rule of three points, from -1 to 1.
constexpr std::array<std::array<double, 2>, 3> gauss {
    { { -0.7745966692414834, 5.0 / 9.0 },
      { 0.0, 8.0 / 9.0 },
      { 0.7745966692414834, 5.0 / 9.0 } }
};

} // namespace

double Spectrum::at(double wavelength) const
{
    const auto between = place(wavelengths, wavelength);
    if (!between)
        return 0.0;
    const auto& [i, share] = *between;
    return values[i] + share * (values[i + 1] - values[i]);
}

Vec3 SpectralSensitivities::at(double wavelength) const
{
    const auto between = place(wavelengths, wavelength);
    if (!between)
        return {};
    const auto& [i, share] = *between;
    // A photon's energy goes by 1 / wavelength; 555 nm keeps numbers near 1.
    const double per_energy = unit == SpectralUnit::photon ? wavelength / 555.0 : 1.0;
    Vec3 result;
    for (std::size_t c = 0; c < 3; ++c)
        result[c] = per_energy * (rgb[i][c] + share * (rgb[i + 1][c] - rgb[i][c]));
    return result;
}

std::vector<QuadraturePoint> quadrature(const std::vector<double>& nodes, double from,
                                        double to)
{
    std::vector<QuadraturePoint> points;
    for (std::size_t i = 1; i < nodes.size(); ++i) {
        const double a = std::max(nodes[i - 1], from), b = std::min(nodes[i], to);
        if (!(b > a))
            continue;
        const double middle = 0.5 * (a + b), half = 0.5 * (b - a);
        for (const auto& [at, weight] : gauss)
            points.push_back({ middle + half * at, half * weight });
    }
    return points;
}

std::vector<double> merged(const std::vector<double>& a, const std::vector<double>& b)
{
    std::vector<double> all;
    std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(all));
    return all;
}

Vec3 response(const SpectralSensitivities& sensitivities, const Spectrum& light)
{
    const std::vector<double> nodes
        = merged(sensitivities.wavelengths, light.wavelengths);
    Vec3 result {};
    for (const auto& [nm, weight] : quadrature(nodes, visible_from, visible_to)) {
        const double power = weight * light.at(nm);
        const Vec3 sensitivity = sensitivities.at(nm);
        for (std::size_t c = 0; c < 3; ++c)
            result[c] += power * sensitivity[c];
    }
    for (double seen : result)
        if (!(seen > 0.0))
            throw Error("spectral_sensitivities: a channel sees " + number(seen)
                        + " of the light; each must see something of it");
    return result;
}

SpectralUnit spectral_unit_from_name(std::string_view name)
{
    for (SpectralUnit unit : { SpectralUnit::energy, SpectralUnit::photon })
        if (name == name_of(unit))
            return unit;
    throw Error("\"" + std::string(name)
                + "\" must be energy (response to radiant energy) or photon (quantum "
                  "efficiency)");
}

const char* name_of(SpectralUnit unit)
{
    return unit == SpectralUnit::energy ? "energy" : "photon";
}

void check(const SpectralSensitivities& sensitivities, const std::string& file)
{
    check_wavelengths(sensitivities.wavelengths, file);
    if (sensitivities.rgb.size() != sensitivities.wavelengths.size())
        fail(file,
             "has " + std::to_string(sensitivities.wavelengths.size())
                 + " wavelengths, but values for "
                 + std::to_string(sensitivities.rgb.size()));
    for (std::size_t channel : { 0, 1, 2 })
        check_channel(sensitivities, channel, file);
    if (!(sensitivities.scale > 0.0 && std::isfinite(sensitivities.scale)))
        fail(file, "scale " + number(sensitivities.scale) + " must be above 0");
}

} // namespace cg2raw

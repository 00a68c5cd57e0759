// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/spectrum.h"

#include "cg2raw/types.h"
#include "text.h"

#include <algorithm>
#include <cmath>

namespace cg2raw {
namespace {

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
    if (lowest < -spectral_noise * peak)
        fail(file,
             name + " falls to " + number(lowest) + "; noise may reach "
                 + number(-spectral_noise * peak) + ", 1 % of its peak");
}

} // namespace

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

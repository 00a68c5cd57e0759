// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Spectra, and what a sensor's channels see of them.
#pragma once

#include "cg2raw/color.h"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace cg2raw {

/// A quantity over wavelengths: linear between them, 0 outside.
struct Spectrum {
    std::vector<double> wavelengths; ///< nm, rising
    std::vector<double> values;

    double at(double wavelength) const;
};

/// A spectrum of pairs of wavelength in nm and value, in any order. Throws Error unless
/// there are two or more, of wavelengths that differ, and values are finite and not
/// negative, one of them above 0.
Spectrum spectrum_from_rows(std::vector<std::pair<double, double>> rows);
/// The same of "550nm:0.3;560nm:0.4;", as spectral images state lights and responses;
/// frequencies too (545THz:0.3;).
/// Source: Fichet, Pacanowski and Wilkie, JCGT 10(3), 2021.
Spectrum spectrum_from_text(std::string_view text);

/// What the response of a channel is a response to.
enum class SpectralUnit {
    energy, ///< radiant energy (A/W): what cameras are measured by
    photon, ///< a photon (quantum efficiency)
};
/// "energy" or "photon". Throws Error on other words.
SpectralUnit spectral_unit_from_name(std::string_view name);
const char* name_of(SpectralUnit unit);

/// Spectral sensitivities of R, G and B, as measured; linear between wavelengths, 0
/// outside them.
struct SpectralSensitivities {
    std::vector<double> wavelengths; ///< nm, rising
    std::vector<Vec3> rgb; ///< of a monochrome sensor all three are alike
    SpectralUnit unit = SpectralUnit::energy;
    double scale = 1.0; ///< what 1 stands for in the numbers that were measured

    /// Response to radiant energy at @p wavelength, whatever the unit.
    Vec3 at(double wavelength) const;
};

/// The visible range, which sensitivities have to cover, and the longest step between
/// them, nm. Source: CIE 015, 7.2.
constexpr double visible_from = 380.0, visible_to = 780.0, longest_spectral_step = 20.0;
/// Measured sensitivities dip below 0 by noise, by at most this share of their peak.
constexpr double spectral_noise = 0.01;

/// Throws Error, led by @p file, unless wavelengths rise, cover the visible range
/// without a gap, and each channel sees something.
void check(const SpectralSensitivities& sensitivities, const std::string& file);

/// Where an integrand is taken, and what its value there counts.
struct QuadraturePoint {
    double wavelength; ///< nm
    double weight; ///< nm
};
/// Points whose sum is the integral from @p from to @p to nm, exact for an integrand of
/// degree 5 at most between @p nodes, which rise: a product of spectra between all
/// their wavelengths. No line between two nodes is lost.
std::vector<QuadraturePoint> quadrature(const std::vector<double>& nodes, double from,
                                        double to);
/// All of both, rising, each once.
std::vector<double> merged(const std::vector<double>& a, const std::vector<double>& b);

/// What the channels see of @p light over the visible range. Throws Error if one of
/// them sees nothing.
Vec3 response(const SpectralSensitivities& sensitivities, const Spectrum& light);

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What a sensor's channels see of each wavelength.
#pragma once

#include "cg2raw/color.h"

#include <string>
#include <string_view>
#include <vector>

namespace cg2raw {

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
};

/// The visible range, which sensitivities have to cover, and the longest step between
/// them, nm. Source: CIE 015, 7.2.
constexpr double visible_from = 380.0, visible_to = 780.0, longest_spectral_step = 20.0;
/// Measured sensitivities dip below 0 by noise, by at most this share of their peak.
constexpr double spectral_noise = 0.01;

/// Throws Error, led by @p file, unless wavelengths rise, cover the visible range
/// without a gap, and each channel sees something.
void check(const SpectralSensitivities& sensitivities, const std::string& file);

} // namespace cg2raw

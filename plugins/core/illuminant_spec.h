// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file A word of the illuminant grammar, taken apart; private to the core.
#pragma once

#include "cg2raw/illuminant.h"

namespace cg2raw {

struct IlluminantSpec {
    enum class Kind { xy, kelvin, neutral, sample, measured, as_shot, lamp } kind;
    double a = 0.0, b = 0.0; ///< x, y; temperature; R/G, B/G
    std::uint32_t index = 0; ///< of a draw
    std::string name {}; ///< of a lamp
};

/// Throws Error that lists the grammar.
IlluminantSpec parse_illuminant(std::string_view spec);

/// (R/G, B/G) of draw @p index: the profile's Gaussian inside its hull, or the
/// Planckian locus between the two calibration illuminants where fewer than 3 neutrals
/// are known. Throws Error if the profile has neither.
std::array<double, 2> sampled_neutral(const SensorProfile& profile,
                                      std::uint32_t index);

/// (R/G, B/G) of draw @p index: a point between one of the profile's measured neutrals
/// and one of those nearest to it. Throws Error if the profile has fewer than 3.
std::array<double, 2> measured_neutral(const SensorProfile& profile,
                                       std::uint32_t index);

/// A neutral of camera RGB: G = 1, at 1e-6.
Vec3 over_green(const Vec3& camera);

/// Index of the warmer and the cooler calibration; the same if there is but one.
std::array<std::size_t, 2> warm_and_cool(const SensorProfile& profile);

/// Neutral (G = 1, at 1e-6) of a light of chromaticity @p xy. Throws Error if the
/// sensor's matrix makes a channel of it 0 or less.
Vec3 neutral_from_xy(const SensorProfile& profile, Chromaticity xy);

} // namespace cg2raw

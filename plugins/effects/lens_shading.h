// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The formula of lens_shading, for what undoes it or fits it: GainMaps of DNG.
#pragma once

#include "cg2raw/effect.h"

namespace cg2raw {

/// Parameters of the effect lens_shading, and those of them that come first: of a lens
/// that is round, but for a shift of its centre.
constexpr std::size_t lens_shading_size = 27, round_lens_shading_size = 7;

/// What each parameter is multiplied by at (u, v): the powers of u and v up to the
/// sixth, but for their constant, in polar coordinates.
std::array<double, lens_shading_size> lens_shading_terms(double u, double v);

/// Relative illumination at (u, v) for the first of the values of the effect
/// lens_shading, or all of them; never below 0.
double lens_shading_at(const Values& values, double u, double v);

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The formula of color_shading, for what undoes it: GainMaps of DNG.
#pragma once

#include "cg2raw/effect.h"

namespace cg2raw {

/// That of colour @p color (0 = R, 2 = B) over green's for the values of the effect
/// color_shading; never below 0, and 1 for green.
double color_shading_at(const Values& values, int color, double u, double v);

} // namespace cg2raw

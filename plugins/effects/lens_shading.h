// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The formula of lens_shading, for what undoes it: GainMaps of DNG.
#pragma once

#include "cg2raw/effect.h"

namespace cg2raw {

/// Relative illumination at (u, v) for the values of the effect lens_shading; never
/// below 0.
double lens_shading_at(const Values& values, double u, double v);

} // namespace cg2raw

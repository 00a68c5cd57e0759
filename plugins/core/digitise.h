// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The last step of a pixel: its noise is drawn, and it becomes a DN.
#pragma once

#include "cg2raw/profile.h"
#include "cg2raw/random.h"

namespace cg2raw {

/// Black and white level in the arithmetic of pixels.
struct Levels {
    CfaPattern cfa;
    std::array<float, 36> black; ///< DN, per CFA site
    float white; ///< DN
};
Levels levels_of(const SensorProfile& profile);

/// noise += sqrt(variance) times a standard normal of each site.
void add_gaussian(const Rng& rng, Site origin, const Plane<float>& variance,
                  const Plane<float>& noise);

/// mean += noise; sites of @p ceiling and above stay as they are.
void add_noise(const Plane<float>& noise, float ceiling, const Plane<float>& mean);

/// DN = round(signal (white - black) + black), clamped to 0 ... white; a row. The
/// rounding is a quantisation noise of variance 1/12 DN^2.
void digitise(const float* signal, const Levels& levels, Site at, int width,
              std::uint16_t* dn);

/// signal = (DN - black) / (white - black), a row.
void undo_digitise(const std::uint16_t* dn, const Levels& levels, Site at, int width,
                   float* signal);

} // namespace cg2raw

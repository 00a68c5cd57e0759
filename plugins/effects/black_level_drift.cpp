// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file A black level that wanders: all pixels of a frame share one Gaussian offset,
/// drawn anew in every frame. Its variance is each pixel's; within a frame it is fully
/// correlated.
#include "cg2raw/effect.h"

#include "even_variance.h"

namespace cg2raw::effects {
namespace {

void predict(Signal& signal, const Values& values)
{
    add_even_variance(signal, float(values[0] * values[0]));
}

void draw(Signal& signal, const Values& values, const Rng& rng)
{
    float normal = 0.0f;
    rng.normals({ 0, 0 }, 1, &normal);
    const float offset = float(values[0]) * normal;
    for (int row = 0; row < signal.noise.height; ++row)
        for (int col = 0; col < signal.noise.width; ++col)
            signal.noise.row(row)[col] += offset;
}

} // namespace

Effect black_level_drift()
{
    return { "black_level_drift",
             Stage::readout,
             Pattern::temporal,
             { { "sigma", "1", 0.0, 1.0, 0.0,
                 "standard deviation of a frame's offset" } },
             "a black level that differs from frame to frame",
             "J. R. Janesick, Photon Transfer, 2007 (offset errors)",
             predict,
             draw };
}

} // namespace cg2raw::effects

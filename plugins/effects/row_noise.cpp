// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Banding: all pixels of a row share one Gaussian offset, drawn anew in every
/// frame. Its variance is each pixel's; within a row it is fully correlated.
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
    for (int row = 0; row < signal.noise.height; ++row) {
        float normal = 0.0f;
        rng.normals({ signal.origin.row + row, 0 }, 1, &normal);
        const float offset = float(values[0]) * normal;
        for (int col = 0; col < signal.noise.width; ++col)
            signal.noise.row(row)[col] += offset;
    }
}

} // namespace

Effect row_noise()
{
    return { "row_noise",
             Stage::readout,
             Pattern::temporal,
             { { "sigma", "1", 0.0, 1.0, 0.0,
                 "standard deviation of a row's offset" } },
             "banding: one offset per row and frame",
             "K. Wei et al., IEEE Trans. PAMI 44(11), 2022",
             predict,
             draw };
}

} // namespace cg2raw::effects

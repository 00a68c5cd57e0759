// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Stripes: all pixels of a column share one offset, that of its amplifier and
/// ADC, the same in every frame.
#include "cg2raw/effect.h"

namespace cg2raw::effects {
namespace {

void predict(Signal&, const Values&) { }

void draw(Signal& signal, const Values& values, const Rng& rng)
{
    const int width = signal.noise.width;
    std::vector<float> offset(std::size_t(width), 0.0f);
    rng.normals({ 0, signal.origin.col }, width, offset.data());
    for (float& value : offset)
        value *= float(values[0]);
    for (int row = 0; row < signal.noise.height; ++row) {
        float* const noise = signal.noise.row(row);
        for (int col = 0; col < width; ++col)
            noise[col] += offset[std::size_t(col)];
    }
}

} // namespace

Effect column_fixed_pattern()
{
    return { "column_fixed_pattern",
             Stage::readout,
             Pattern::fixed,
             { { "sigma", "1", 0.0, 1.0, 0.0,
                 "standard deviation of a column's offset" } },
             "stripes: one offset per column, the same in every frame",
             "A. El Gamal, B. Fowler, H. Min, X. Liu, Proc. SPIE 3301, 1998",
             predict,
             draw };
}

} // namespace cg2raw::effects

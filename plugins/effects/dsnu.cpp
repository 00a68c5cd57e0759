// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Dark signal non-uniformity: each pixel's own offset, the same in every frame.
#include "cg2raw/effect.h"

#include "site_pieces.h"

namespace cg2raw::effects {
namespace {

void predict(Signal&, const Values&) { }

void draw(Signal& signal, const Values& values, const Rng& rng)
{
    const float sigma = float(values[0]);
    float normal[most_in_piece];
    for (int row = 0; row < signal.noise.height; ++row)
        for (int col = 0; col < signal.noise.width; col += most_in_piece) {
            const int count = std::min(most_in_piece, signal.noise.width - col);
            rng.normals({ signal.origin.row + row, signal.origin.col + col }, count,
                        normal);
            float* const noise = signal.noise.row(row) + col;
            for (int i = 0; i < count; ++i)
                noise[i] += sigma * normal[i];
        }
}

} // namespace

Effect dsnu()
{
    return { "dsnu",
             Stage::readout,
             Pattern::fixed,
             { { "sigma", "1", 0.0, 1.0, 0.0,
                 "standard deviation of the pixels' offset" } },
             "dark signal non-uniformity: an offset per pixel, the same in every frame",
             "EMVA Standard 1288, release 4.0",
             predict,
             draw };
}

} // namespace cg2raw::effects

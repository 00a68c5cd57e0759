// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Photo response non-uniformity: each pixel's own sensitivity.
#include "cg2raw/effect.h"

#include "site_pieces.h"

namespace cg2raw::effects {
namespace {

void predict(Signal&, const Values&) { }

void draw(Signal& signal, const Values& values, const Rng& rng)
{
    const float sigma = float(values[0]);
    const Plane<float>& mosaic = signal.mean[0];
    float normal[most_in_piece];
    for (int row = 0; row < mosaic.height; ++row)
        for (int col = 0; col < mosaic.width; col += most_in_piece) {
            const int count = std::min(most_in_piece, mosaic.width - col);
            rng.normals({ signal.origin.row + row, signal.origin.col + col }, count,
                        normal);
            float* const mean = mosaic.row(row) + col;
            for (int i = 0; i < count; ++i)
                mean[i] *= 1.0f + sigma * normal[i];
        }
}

} // namespace

Effect prnu()
{
    return { "prnu",
             Stage::pixel,
             Pattern::fixed,
             { { "sigma", "1", 0.0, 0.2, 0.0,
                 "standard deviation of the pixels' sensitivity, relative" } },
             "photo response non-uniformity: a factor per pixel",
             "EMVA Standard 1288, release 4.0",
             predict,
             draw };
}

} // namespace cg2raw::effects

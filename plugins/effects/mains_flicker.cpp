// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Light that flickers with the mains while a rolling shutter reads row after
/// row: bands in proportion to the light, of a phase that is new in every frame. Its
/// variance is over frames.
#include "cg2raw/effect.h"

#include <cmath>

namespace cg2raw::effects {
namespace {

constexpr double turn = 6.283185307179586;

void predict(Signal& signal, const Values& values)
{
    const float share = float(values[0] * values[0] / 2.0);
    for (int row = 0; row < signal.mean[0].height; ++row)
        for (int col = 0; col < signal.mean[0].width; ++col) {
            const float mean = signal.mean[0].row(row)[col];
            signal.variance.row(row)[col] += share * mean * mean;
        }
}

void draw(Signal& signal, const Values& values, const Rng& rng)
{
    const double amplitude = values[0], period = values[1];
    const double phase = turn * rng.uniform(0);
    for (int row = 0; row < signal.mean[0].height; ++row) {
        const double at = signal.origin.row + row;
        const float factor
            = float(1.0 + amplitude * std::cos(turn * at / period + phase));
        float* const mean = signal.mean[0].row(row);
        for (int col = 0; col < signal.mean[0].width; ++col)
            mean[col] *= factor;
    }
}

} // namespace

Effect mains_flicker()
{
    return { "mains_flicker",
             Stage::pixel,
             Pattern::temporal,
             { { "amplitude", "1", 0.0, 0.5, 0.0,
                 "of the wave, relative to the light" },
               { "period", "px", 4.0, 100000.0, 4.0, "rows of one wave" } },
             "bands of mains light on a rolling shutter: a wave of brightness down the "
             "rows, of another phase in every frame",
             "M. Sheinin et al., Computational Imaging on the Electric Grid, CVPR 2017",
             predict,
             draw };
}

} // namespace cg2raw::effects

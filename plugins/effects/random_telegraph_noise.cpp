// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Few pixels jump between two levels from frame to frame, as a trap in their
/// transistor is empty or not; which ones, and how far, is the sensor's. One uniform
/// says both, as of hot_pixels: a larger fraction adds pixels to those that jump.
#include "cg2raw/effect.h"

#include "elementary.h"
#include "even_variance.h"
#include "site_pieces.h"

namespace cg2raw::effects {
namespace {

/// Over all pixels: which ones jump is not known to it. The mean square of half an
/// exponential step is half its mean's square.
void predict(Signal& signal, const Values& values)
{
    add_even_variance(signal, float(values[0] * values[1] * values[1] / 2.0));
}

void draw(Signal& signal, const Values& values, const Rng& rng)
{
    const double fraction = values[0], amplitude = values[1];
    if (fraction == 0.0 || amplitude == 0.0)
        return;
    const Rng of_sensor = rng.fixed();
    double pixel[most_in_piece], state[most_in_piece];
    for (int row = 0; row < signal.noise.height; ++row)
        for (int col = 0; col < signal.noise.width; col += most_in_piece) {
            const int count = std::min(most_in_piece, signal.noise.width - col);
            const Site at { signal.origin.row + row, signal.origin.col + col };
            of_sensor.uniforms(at, count, pixel);
            rng.uniforms(at, count, state);
            float* const noise = signal.noise.row(row) + col;
            for (int i = 0; i < count; ++i) {
                if (!(pixel[i] < fraction))
                    continue;
                const double half = -0.5 * amplitude * natural_log(pixel[i] / fraction);
                noise[i] += float(state[i] < 0.5 ? -half : half);
            }
        }
}

} // namespace

Effect random_telegraph_noise()
{
    return { "random_telegraph_noise",
             Stage::readout,
             Pattern::temporal,
             { { "fraction", "1", 0.0, 0.2, 0.0, "part of the pixels that jump" },
               { "amplitude", "1", 0.0, 1.0, 0.0,
                 "mean distance of their two levels" } },
             "few pixels that jump between two levels from frame to frame",
             "X. Wang et al., IEDM 2006 (random telegraph signal in image sensors)",
             predict,
             draw };
}

} // namespace cg2raw::effects

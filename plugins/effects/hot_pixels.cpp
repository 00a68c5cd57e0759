// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Few pixels that gather charge without light, each at a rate of its own that
/// is distributed exponentially. One uniform says both: below the fraction the pixel is
/// hot, and how far below makes its rate, so that a larger fraction adds pixels to
/// those that are hot. It is charge, and has the shot noise of charge.
#include "cg2raw/effect.h"

#include "elementary.h"
#include "site_pieces.h"

namespace cg2raw::effects {
namespace {

void predict(Signal&, const Values&) { }

void draw(Signal& signal, const Values& values, const Rng& rng)
{
    const double fraction = values[0], rate = values[1];
    if (fraction == 0.0 || rate == 0.0)
        return;
    const double mean_charge = rate * signal.exposure.seconds.value();
    double uniform[most_in_piece];
    for (int row = 0; row < signal.mean[0].height; ++row)
        for (int col = 0; col < signal.mean[0].width; col += most_in_piece) {
            const int count = std::min(most_in_piece, signal.mean[0].width - col);
            rng.uniforms({ signal.origin.row + row, signal.origin.col + col }, count,
                         uniform);
            float* const mean = signal.mean[0].row(row) + col;
            for (int i = 0; i < count; ++i)
                if (uniform[i] < fraction)
                    mean[i] -= float(mean_charge * natural_log(uniform[i] / fraction));
        }
}

} // namespace

Effect hot_pixels()
{
    Effect effect { "hot_pixels",
                    Stage::response,
                    Pattern::fixed,
                    { { "fraction", "1", 0.0, 0.2, 0.0, "part of the pixels" },
                      { "rate", "1/s", 0.0, 100.0, 0.0,
                        "mean signal that a second without light leaves in one" } },
                    "few pixels that gather charge without light",
                    "R. Widenhorn et al., Proc. SPIE 4669, 2002 (dark current tails)",
                    predict,
                    draw };
    effect.needs_exposure_time = true;
    return effect;
}

} // namespace cg2raw::effects

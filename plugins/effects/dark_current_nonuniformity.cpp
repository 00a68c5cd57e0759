// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Dark current that differs from pixel to pixel, log-normally, so that its
/// median stays that of dark_current. It is charge, and has the shot noise of charge.
#include "cg2raw/effect.h"

#include "elementary.h"
#include "site_pieces.h"

namespace cg2raw::effects {
namespace {

void predict(Signal&, const Values&) { }

void draw(Signal& signal, const Values& values, const Rng& rng)
{
    const double rate = values[0], log_sigma = values[1];
    if (rate == 0.0 || log_sigma == 0.0)
        return;
    const double charge = rate * signal.exposure.seconds.value();
    float normal[most_in_piece];
    for (int row = 0; row < signal.mean[0].height; ++row)
        for (int col = 0; col < signal.mean[0].width; col += most_in_piece) {
            const int count = std::min(most_in_piece, signal.mean[0].width - col);
            rng.normals({ signal.origin.row + row, signal.origin.col + col }, count,
                        normal);
            float* const mean = signal.mean[0].row(row) + col;
            for (int i = 0; i < count; ++i)
                mean[i] += float(charge
                                 * (exponential(log_sigma * double(normal[i])) - 1.0));
        }
}

} // namespace

Effect dark_current_nonuniformity()
{
    Effect effect {
        "dark_current_nonuniformity",
        Stage::response,
        Pattern::fixed,
        { { "rate", "1/s", 0.0, 10.0, 0.0,
            "scale of e^(log_sigma n) - 1, n normal, added to dark_current (the "
            "median), which should be at least this rate" },
          { "log_sigma", "1", 0.0, 3.0, 0.0,
            "standard deviation of the log of a pixel's rate" } },
        "dark current that differs from pixel to pixel",
        "R. L. Baer, Proc. SPIE 6068, 2006 (log-normal)",
        predict,
        draw
    };
    effect.needs_exposure_time = true;
    return effect;
}

} // namespace cg2raw::effects

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Greens that differ between rows of red and rows of blue: what surrounds a
/// green pixel, and which amplifier reads it, differs.
#include "cg2raw/effect.h"

namespace cg2raw::effects {
namespace {

constexpr int red = 0, green = 1;

bool has_red(const CfaPattern& cfa, int row)
{
    return cfa.color({ row, 0 }) == red || cfa.color({ row, 1 }) == red;
}

void predict(Signal& signal, const Values& values)
{
    const CfaPattern& cfa = signal.exposure.cfa;
    for (int row = 0; row < signal.mean[0].height; ++row) {
        const Site at { signal.origin.row + row, signal.origin.col };
        const float factor
            = float(1.0 + (has_red(cfa, at.row) ? values[0] : values[1]));
        const int first = cfa.color(at) == green ? 0 : 1;
        float* const mean = signal.mean[0].row(row);
        for (int col = first; col < signal.mean[0].width; col += 2)
            mean[col] *= factor;
    }
}

} // namespace

Effect gr_gb_imbalance()
{
    return { "gr_gb_imbalance",
             Stage::pixel,
             Pattern::none,
             { { "gr", "1", -0.5, 0.5, 0.0, "excess of the greens in rows of red",
                 CfaRepeat::bayer },
               { "gb", "1", -0.5, 0.5, 0.0, "excess of the greens in rows of blue",
                 CfaRepeat::bayer } },
             "greens of a Bayer CFA that differ between its rows",
             "DNG specification 1.6, BayerGreenSplit",
             predict };
}

} // namespace cg2raw::effects

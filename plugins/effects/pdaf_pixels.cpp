// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Pixels of a regular grid that find the focus: half their aperture is masked,
/// or they have a filter of their own, and what is left of that is another sensitivity.
#include "cg2raw/effect.h"

#include <cmath>

namespace cg2raw::effects {
namespace {

/// The way from a place to the first of @p offset, modulo the pitch.
int way_to(int offset, int place, int pitch)
{
    return ((offset - place) % pitch + pitch) % pitch;
}

void predict(Signal& signal, const Values& values)
{
    const float factor = float(1.0 + values[0]);
    const int pitch = int(std::lround(values[1]));
    const int first_row = way_to(int(std::lround(values[2])), signal.origin.row, pitch);
    const int first_col = way_to(int(std::lround(values[3])), signal.origin.col, pitch);
    for (int row = first_row; row < signal.mean[0].height; row += pitch)
        for (int col = first_col; col < signal.mean[0].width; col += pitch)
            signal.mean[0].row(row)[col] *= factor;
}

} // namespace

Effect pdaf_pixels()
{
    constexpr double longest = 64.0;
    constexpr auto any = CfaRepeat::any;
    return { "pdaf_pixels",
             Stage::pixel,
             Pattern::none,
             { { "gain", "1", -0.9, 0.5, 0.0, "excess of the grid's pixels, relative" },
               { "pitch", "px", 4.0, longest, 4.0, "of the grid, in both directions",
                 any, true },
               { "row", "px", 0.0, longest - 1.0, 0.0,
                 "of the first one, modulo the pitch", any, true },
               { "column", "px", 0.0, longest - 1.0, 0.0,
                 "of the first one, modulo the pitch", any, true } },
             "phase-detection pixels: a regular grid of another sensitivity",
             "P. Sliwinski, P. Wachel, J. Computer and Communications 1(6), 2013",
             predict };
}

} // namespace cg2raw::effects

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Magnification that differs between colours: red and blue are resampled about
/// the centre.
#include "cg2raw/effect.h"

#include "radial_displacement.h"

namespace cg2raw::effects {
namespace {

/// A parameter's bound, px at the corner; two of them add up.
constexpr double most = 4.0;
constexpr int most_shift = 2 * int(most);

void predict(Signal& signal, const Values& values)
{
    for (std::size_t color : { 0, 1 }) {
        const double shift = values[color], shift_r2 = values[2 + color];
        if (shift != 0.0 || shift_r2 != 0.0)
            displace(signal, { 2 * color }, most_shift,
                     [&](double square) { return shift + shift_r2 * square; });
    }
}

} // namespace

Effect lateral_chromatic_aberration()
{
    return { "lateral_chromatic_aberration",
             Stage::optics,
             Pattern::none,
             { { "red", "px", -most, most, 0.0,
                 "red is read this far outwards at the corner, growing as r",
                 CfaRepeat::colors },
               { "blue", "px", -most, most, 0.0, "likewise blue", CfaRepeat::colors },
               { "red_r2", "px", -most, most, 0.0, "of red, growing as r^3",
                 CfaRepeat::colors },
               { "blue_r2", "px", -most, most, 0.0, "of blue, growing as r^3",
                 CfaRepeat::colors } },
             "magnification of red and blue that differs from green's",
             "T. E. Boult, G. Wolberg, CVPR 1992; DNG specification 1.6, "
             "WarpRectilinear",
             predict,
             nullptr,
             reach_of_shift(most_shift) };
}

} // namespace cg2raw::effects

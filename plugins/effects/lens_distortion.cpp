// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Magnification that changes over the frame: straight lines are bent, of all
/// colours alike.
#include "cg2raw/effect.h"

#include "radial_displacement.h"

namespace cg2raw::effects {
namespace {

/// A parameter's bound, px at the corner; two of them add up.
constexpr double most = 8.0;
constexpr int most_shift = 2 * int(most);

void predict(Signal& signal, const Values& values)
{
    const double r2 = values[0], r4 = values[1];
    if (r2 != 0.0 || r4 != 0.0)
        displace(signal, { 0, 1, 2 }, most_shift,
                 [&](double square) { return (r2 + r4 * square) * square; });
}

} // namespace

Effect lens_distortion()
{
    return { "lens_distortion",
             Stage::optics,
             Pattern::none,
             { { "r2", "px", -most, most, 0.0,
                 "light is read this far outwards at the corner, growing as r^3: above "
                 "0 a barrel, below 0 a pincushion" },
               { "r4", "px", -most, most, 0.0, "likewise, growing as r^5" } },
             "radial displacement of all colours alike, which bends straight lines",
             "D. C. Brown, Photogrammetric Engineering 37(8), 1971; DNG specification "
             "1.6, WarpRectilinear",
             predict,
             nullptr,
             reach_of_shift(most_shift) };
}

} // namespace cg2raw::effects

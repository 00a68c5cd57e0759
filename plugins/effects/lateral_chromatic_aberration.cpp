// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Magnification that differs between colours: red and blue are resampled about
/// the centre, by Keys' six-point cubic convolution. Its slope at no shift is exact for
/// cubics, where a windowed sinc of that length shifts a ramp by 17 % too little.
#include "cg2raw/effect.h"

#include "neighbours.h"
#include "plane_rows.h"

#include <algorithm>

namespace cg2raw::effects {
namespace {

constexpr int taps = 6, taps_before = 2, taps_after = 3;
/// Columns are added eight at a time, the last two with no weight.
constexpr int lanes = 8;
/// A parameter's bound, px at the corner; two of them add up.
constexpr double most = 4.0;
constexpr int most_shift = 2 * int(most);

struct Taps {
    int first; ///< from the pixel
    float weight[lanes];
};

/// Weights that interpolate at @p shift from a pixel. Source: R. G. Keys, IEEE Trans.
/// ASSP 29(6), 1981, fourth-order kernel.
inline Taps taps_at(double shift)
{
    const int whole = int(shift + (most_shift + 1)) - (most_shift + 1); // floor
    const float f = float(shift - whole), g = 1.0f - f;
    // The three pieces of the kernel, at distances 0..1, 1..2 and 2..3.
    const auto inner
        = [](float s) { return ((4.0f / 3.0f) * s - 7.0f / 3.0f) * s * s + 1.0f; };
    const auto middle = [](float s) { // at 1 + s
        return (((-7.0f / 12.0f) * s + 1.25f) * s - 2.0f / 3.0f) * s;
    };
    const auto outer = [](float s) { // at 2 + s
        return ((1.0f / 12.0f * s - 1.0f / 6.0f) * s + 1.0f / 12.0f) * s;
    };
    return { whole - taps_before,
             { outer(f), middle(f), inner(f), inner(g), middle(g), outer(g) } };
}

/// The sum of a patch whose first pixel is @p line.
inline float weighted(const float* line, std::ptrdiff_t pitch, const float* across,
                      const float* down)
{
    float sums[lanes] = {};
    for (int i = 0; i < taps; ++i, line += pitch)
        for (int j = 0; j < lanes; ++j)
            sums[j] += down[i] * line[j];
    float sum = 0.0f;
    for (int j = 0; j < taps; ++j)
        sum += across[j] * sums[j];
    return sum;
}

/// A plane magnified about the frame's centre by 1 + (shift + shift_r2 r^2) / half.
void magnify(const Signal& signal, const Plane<float>& plane, double shift,
             double shift_r2)
{
    const Margined from(plane, most_shift + taps_after + lanes - taps);
    each_field_row(signal, [&](int row, const double* u, double v) {
        float* const out = plane.row(row);
        for (int col = 0; col < plane.width; ++col) {
            // Outside of the frame, in a block's margin, r^2 is held at the corner's.
            const double square = std::min(1.0, u[col] * u[col] + v * v);
            const double moved = shift + shift_r2 * square;
            const Taps x = taps_at(moved * u[col]), y = taps_at(moved * v);
            out[col] = weighted(from.row(row + y.first) + col + x.first, from.pitch(),
                                x.weight, y.weight);
        }
    });
}

void predict(Signal& signal, const Values& values)
{
    for (std::size_t color : { 0, 1 }) {
        const double shift = values[color], shift_r2 = values[2 + color];
        if (shift != 0.0 || shift_r2 != 0.0)
            magnify(signal, signal.mean[2 * color], shift, shift_r2);
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
             most_shift + taps_after };
}

} // namespace cg2raw::effects

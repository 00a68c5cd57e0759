// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file For effects that read planes elsewhere on the same radius, by Keys' six-point
/// cubic convolution. Its slope at no shift is exact for cubics, where a windowed sinc
/// of that length shifts a ramp by 17 % too little.
#pragma once

#include "cg2raw/effect.h"

#include "neighbours.h"
#include "plane_rows.h"

#include <algorithm>
#include <vector>

namespace cg2raw::effects {

constexpr int taps = 6, taps_before = 2, taps_after = 3;
/// Columns are added eight at a time, the last two with no weight.
constexpr int lanes = 8;

struct Taps {
    int first; ///< from the pixel
    float weight[lanes];
};

/// Weights that interpolate at @p shift from a pixel, -most_shift ... most_shift.
/// Source: R. G. Keys, IEEE Trans. ASSP 29(6), 1981, fourth-order kernel.
inline Taps taps_at(double shift, int most_shift)
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

/// Effect::reach of displacements up to @p most_shift px.
constexpr int reach_of_shift(int most_shift) { return most_shift + taps_after; }

/// Reads the planes of signal.mean in @p planes radially outwards by r *
/// over_radius(r^2) px, r = 1 in the frame's corner; at most @p most_shift px either
/// way.
template <class OverRadius>
void displace(const Signal& signal, const std::vector<std::size_t>& planes,
              int most_shift, const OverRadius& over_radius)
{
    std::vector<Margined> from;
    for (const std::size_t plane : planes)
        from.emplace_back(signal.mean[plane],
                          reach_of_shift(most_shift) + lanes - taps);
    each_field_row(signal, [&](int row, const double* u, double v) {
        for (int col = 0; col < signal.mean[0].width; ++col) {
            // Outside of the frame, in a block's margin, r^2 is held at the corner's.
            const double moved = over_radius(std::min(1.0, u[col] * u[col] + v * v));
            const Taps x = taps_at(moved * u[col], most_shift);
            const Taps y = taps_at(moved * v, most_shift);
            for (std::size_t i = 0; i < planes.size(); ++i)
                signal.mean[planes[i]].row(row)[col]
                    = weighted(from[i].row(row + y.first) + col + x.first,
                               from[i].pitch(), x.weight, y.weight);
        }
    });
}

} // namespace cg2raw::effects

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file For effects that treat the pixels of a plane alike, or by their field
/// position.
#pragma once

#include "cg2raw/effect.h"

#include <cmath>
#include <vector>

namespace cg2raw {

inline void scale(const Plane<float>& plane, float factor)
{
    for (int row = 0; row < plane.height; ++row) {
        float* const pixels = plane.row(row);
        for (int col = 0; col < plane.width; ++col)
            pixels[col] *= factor;
    }
}

/// Where a site lies: offset from the frame's centre in half diagonals, to the right
/// and downwards.
struct FieldPosition {
    double u, v;
};
inline FieldPosition field_position(const Signal& signal, int row, int col)
{
    const auto [width, height] = signal.exposure.frame;
    const double half = std::hypot(width, height) / 2.0;
    return { (signal.origin.col + col + 0.5 - width / 2.0) / half,
             (signal.origin.row + row + 0.5 - height / 2.0) / half };
}

/// Calls work(row, u, v) for every row: u of each of its columns, and the row's v.
template <class Work> void each_field_row(const Signal& signal, const Work& work)
{
    std::vector<double> u(std::size_t(signal.mean[0].width));
    for (std::size_t col = 0; col < u.size(); ++col)
        u[col] = field_position(signal, 0, int(col)).u;
    for (int row = 0; row < signal.mean[0].height; ++row)
        work(row, u.data(), field_position(signal, row, 0).v);
}

} // namespace cg2raw

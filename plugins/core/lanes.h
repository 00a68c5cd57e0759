// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Sums in a fixed order that vectorises: every eighth number in a lane of its
/// own.
#pragma once

namespace cg2raw {

constexpr int lanes = 8;

inline double total(const double* values, int count)
{
    double sums[lanes] {};
    int i = 0;
    for (; i + lanes <= count; i += lanes)
        for (int lane = 0; lane < lanes; ++lane)
            sums[lane] += values[i + lane];
    for (int lane = 0; i < count; ++i, ++lane)
        sums[lane] += values[i];
    return ((sums[0] + sums[1]) + (sums[2] + sums[3]))
        + ((sums[4] + sums[5]) + (sums[6] + sums[7]));
}

inline double dot(const double* a, const double* b, int count)
{
    double sums[lanes] {};
    int i = 0;
    for (; i + lanes <= count; i += lanes)
        for (int lane = 0; lane < lanes; ++lane)
            sums[lane] += a[i + lane] * b[i + lane];
    for (int lane = 0; i < count; ++i, ++lane)
        sums[lane] += a[i] * b[i];
    return ((sums[0] + sums[1]) + (sums[2] + sums[3]))
        + ((sums[4] + sums[5]) + (sums[6] + sums[7]));
}

} // namespace cg2raw

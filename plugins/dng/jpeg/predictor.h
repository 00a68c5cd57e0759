// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The predictors of lossless JPEG.
#pragma once

namespace cg2raw {

/// They are numbered from 1.
constexpr int predictors = 7;

/// What a sample is predicted to be, of the same component's samples to the left,
/// above, and above left. Source: ITU-T T.81 (1992), table H.1.
template <int predictor> int predicted(int left, int above, int corner)
{
    static_assert(predictor >= 1 && predictor <= predictors, "T.81 has seven");
    switch (predictor) {
    case 1:
        return left;
    case 2:
        return above;
    case 3:
        return corner;
    case 4:
        return left + above - corner;
    case 5:
        return left + ((above - corner) >> 1);
    case 6:
        return above + ((left - corner) >> 1);
    default:
        return (left + above) >> 1;
    }
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What all pixels of a signal have the same variance of.
#ifndef CG2RAW_EFFECTS_EVEN_VARIANCE_H
#define CG2RAW_EFFECTS_EVEN_VARIANCE_H

#include "cg2raw/effect.h"

namespace cg2raw::effects {

/// Adds a variance to that of every pixel.
inline void add_even_variance(Signal& signal, float variance)
{
    for (int row = 0; row < signal.variance.height; ++row)
        for (int col = 0; col < signal.variance.width; ++col)
            signal.variance.row(row)[col] += variance;
}

} // namespace cg2raw::effects

#endif

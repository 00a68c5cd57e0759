// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file An ADC coarser than the file's DN: the signal is rounded to multiples of a
/// step. The rounding to the file's own DN is no effect but the last line of every
/// simulation (digitise.cpp); it is the uniform quantisation noise of 1 DN in the model
/// of Wei et al., of variance 1/12 DN^2.
#include "cg2raw/effect.h"

#include "even_variance.h"

#include <cmath>

namespace cg2raw::effects {
namespace {

/// Of rounding a signal that is spread over more than a step. Source: B. Widrow,
/// IRE Trans. Circuit Theory 3(4), 1956.
void predict(Signal& signal, const Values& values)
{
    add_even_variance(signal, float(values[0] * values[0] / 12.0));
}

/// What reached white stays white: the ADC's last code is its white.
void draw(Signal& signal, const Values& values, const Rng&)
{
    const float step = float(values[0]);
    if (!(step > 0.0f))
        return;
    for (int row = 0; row < signal.mean[0].height; ++row) {
        float* const mean = signal.mean[0].row(row);
        for (int col = 0; col < signal.mean[0].width; ++col)
            if (mean[col] < saturated)
                mean[col] = std::floor(mean[col] / step + 0.5f) * step;
    }
}

} // namespace

Effect quantisation()
{
    return { "quantisation",
             Stage::adc,
             Pattern::none,
             { { "step", "1", 0.0, 0.1, 0.0, "of the ADC, above black" } },
             "an ADC that is coarser than the DN of the file",
             "K. Wei et al., IEEE Trans. PAMI 44(11), 2022",
             predict,
             draw };
}

} // namespace cg2raw::effects

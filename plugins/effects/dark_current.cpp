// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Charge that gathers without light, in proportion to the exposure time. It is
/// there before the noise is drawn, and has shot noise of its own.
#include "cg2raw/effect.h"

namespace cg2raw::effects {
namespace {

void predict(Signal& signal, const Values& values)
{
    if (values[0] == 0.0)
        return;
    const float charge = float(values[0] * signal.exposure.seconds.value());
    for (int row = 0; row < signal.mean[0].height; ++row) {
        float* const mean = signal.mean[0].row(row);
        for (int col = 0; col < signal.mean[0].width; ++col)
            mean[col] += charge;
    }
}

} // namespace

Effect dark_current()
{
    Effect effect { "dark_current",
                    Stage::response,
                    Pattern::none,
                    { { "per_second", "1/s", -0.01, 10.0, 0.0,
                        "signal that a second without light leaves" } },
                    "charge that gathers without light",
                    "EMVA Standard 1288, release 4.0",
                    predict };
    effect.needs_exposure_time = true;
    return effect;
}

} // namespace cg2raw::effects

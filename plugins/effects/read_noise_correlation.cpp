// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Read noise of neighbours in a row correlates: what reads pixels one after the
/// other remembers a little of the one before. It has no noise of its own: the noise of
/// the read-out is drawn as an autoregressive process along rows where it is active, of
/// the same variance (run_effects.cpp).
#include "cg2raw/effect.h"

namespace cg2raw::effects {
namespace {

void predict(Signal&, const Values&) { }

} // namespace

Effect read_noise_correlation()
{
    return {
        "read_noise_correlation",
        Stage::readout,
        Pattern::none,
        { { "coefficient", "1", -0.5, 0.5, 0.0,
            "correlation of the read noise with that of the next pixel of the "
            "row" } },
        "read noise that correlates along rows: an autoregressive process of order "
        "1",
        "J. R. Janesick, Scientific Charge-Coupled Devices, 2001 (bandwidth of the "
        "read-out)",
        predict
    };
}

} // namespace cg2raw::effects

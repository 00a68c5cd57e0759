// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Another white than the stated one: red and blue of all light by a factor,
/// against green.
#include "cg2raw/effect.h"

#include "plane_rows.h"

namespace cg2raw::effects {
namespace {

void predict(Signal& signal, const Values& values)
{
    scale(signal.mean[0], float(1.0 + values[0]));
    scale(signal.mean[2], float(1.0 + values[1]));
}

} // namespace

Effect white_balance()
{
    return { "white_balance",
             Stage::color,
             Pattern::none,
             { { "red", "1", -0.95, 10.0, 0.0, "excess of red, relative",
                 CfaRepeat::colors },
               { "blue", "1", -0.95, 10.0, 0.0, "excess of blue, relative",
                 CfaRepeat::colors } },
             "an illuminant that differs from the stated one, as the sensor sees it",
             "J. von Kries, 1902 (coefficient law); DNG specification 1.6, ch. 6",
             predict };
}

} // namespace cg2raw::effects

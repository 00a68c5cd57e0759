// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file More or less light on the sensor than was said: exposure time, aperture,
/// transmission of the lens, or the light's power.
#include "cg2raw/effect.h"

#include "plane_rows.h"

namespace cg2raw::effects {
namespace {

void predict(Signal& signal, const Values& values)
{
    for (const Plane<float>& plane : signal.mean)
        scale(plane, float(1.0 + values[0]));
}

} // namespace

Effect exposure()
{
    return { "exposure",
             Stage::color,
             Pattern::none,
             { { "gain", "1", -0.95, 10.0, 0.0, "excess of light, relative" } },
             "an exposure that differs from the stated one by a factor",
             "ISO 12232:2019 (focal plane exposure)",
             predict };
}

} // namespace cg2raw::effects

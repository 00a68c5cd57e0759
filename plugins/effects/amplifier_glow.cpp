// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Light that the read-out amplifier itself gives off, near a corner or an edge
/// of the frame, for as long as an exposure lasts. It has shot noise.
#include "cg2raw/effect.h"

#include "elementary.h"
#include "plane_rows.h"

namespace cg2raw::effects {
namespace {

/// Extents from the amplifier beyond which nothing is left in float32.
constexpr double most_extents = 100.0;

void predict(Signal& signal, const Values& values)
{
    const double per_second = values[0], extent = values[3];
    if (per_second == 0.0 || extent == 0.0)
        return;
    const auto [width, height] = signal.exposure.frame;
    const double diagonal = std::hypot(width, height);
    const double at_v = values[1] * height / diagonal;
    const double at_u = values[2] * width / diagonal;
    const double charge = per_second * signal.exposure.seconds.value();
    each_field_row(signal, [&](int row, const double* u, double v) {
        float* const mean = signal.mean[0].row(row);
        for (int col = 0; col < signal.mean[0].width; ++col) {
            const double far = std::sqrt((u[col] - at_u) * (u[col] - at_u)
                                         + (v - at_v) * (v - at_v));
            if (far < most_extents * extent)
                mean[col] += float(charge * exponential(-far / extent));
        }
    });
}

} // namespace

Effect amplifier_glow()
{
    Effect effect { "amplifier_glow",
                    Stage::response,
                    Pattern::none,
                    { { "per_second", "1/s", -0.01, 10.0, 0.0,
                        "signal that a second leaves beside the amplifier" },
                      { "row", "1", -1.0, 1.0, 0.0,
                        "of the amplifier: -1 at the top edge, 1 at the bottom" },
                      { "column", "1", -1.0, 1.0, 0.0,
                        "of the amplifier: -1 at the left edge, 1 at the right" },
                      { "extent", "1", 0.0, 1.0, 0.0,
                        "half diagonals over which it falls by a factor e; 0: there is "
                        "no glow" } },
                    "light of the read-out amplifier, which fades into the frame",
                    "J. R. Janesick, Scientific Charge-Coupled Devices, 2001 "
                    "(amplifier luminescence)",
                    predict };
    effect.needs_exposure_time = true;
    return effect;
}

} // namespace cg2raw::effects

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Fall-off of the lens: an even polynomial of the radius, and a tilt for lenses
/// that are off centre. DNG carries its inverse as a GainMap.
#include "cg2raw/effect.h"

#include <algorithm>

namespace cg2raw {

double lens_shading_at(const Values& values, double u, double v)
{
    const double square = u * u + v * v;
    const double radial
        = 1.0 + square * (values[0] + square * (values[1] + square * values[2]));
    return std::max(0.0, radial + values[3] * u + values[4] * v);
}

namespace effects {
namespace {

void expect(Signal& signal, const Values& values)
{
    for (int row = 0; row < signal.mean[0].height; ++row) {
        for (int col = 0; col < signal.mean[0].width; ++col) {
            const auto [u, v] = field_position(signal, row, col);
            const float gain = float(lens_shading_at(values, u, v));
            for (int plane = 0; plane < signal.planes; ++plane)
                signal.mean[std::size_t(plane)].row(row)[col] *= gain;
        }
    }
}

} // namespace

Effect lens_shading()
{
    return {
        "lens_shading",
        Stage::optics,
        Pattern::none,
        { { "r2", "1", -2.0, 2.0, 0.0, "of r^2; r = 1 in the corner" },
          { "r4", "1", -2.0, 2.0, 0.0, "of r^4" },
          { "r6", "1", -2.0, 2.0, 0.0, "of r^6" },
          { "tilt_x", "1", -1.0, 1.0, 0.0, "linear, to the right, per half diagonal" },
          { "tilt_y", "1", -1.0, 1.0, 0.0, "linear, downwards, per half diagonal" } },
        "fall-off of illumination towards the corners",
        "D. B. Goldman, IEEE Trans. PAMI 32(12), 2010 (even polynomial)",
        expect
    };
}

} // namespace effects
} // namespace cg2raw

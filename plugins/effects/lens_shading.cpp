// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Fall-off of the lens: an even polynomial of the radius, and a tilt for lenses
/// that are off centre. DNG carries its inverse as a GainMap.
#include "lens_shading.h"

#include "plane_rows.h"

#include <algorithm>

namespace cg2raw {

double lens_shading_at(const Values& values, double u, double v)
{
    const double square = u * u + v * v;
    const double radial
        = 1.0 + square * (values[0] + square * (values[1] + square * values[2]));
    const double tilt = values[3] * u + values[4] * v;
    return std::max(0.0, radial + tilt + square * (values[5] * u + values[6] * v));
}

namespace effects {
namespace {

void predict(Signal& signal, const Values& values)
{
    each_field_row(signal, [&](int row, const double* u, double v) {
        for (int col = 0; col < signal.mean[0].width; ++col) {
            const float gain = float(lens_shading_at(values, u[col], v));
            for (int plane = 0; plane < signal.planes; ++plane)
                signal.mean[std::size_t(plane)].row(row)[col] *= gain;
        }
    });
}

} // namespace

Effect lens_shading()
{
    return {
        "lens_shading",
        Stage::optics,
        Pattern::none,
        { { "r2", "1", -8.0, 8.0, 0.0, "of r^2; r = 1 in the corner" },
          { "r4", "1", -8.0, 8.0, 0.0, "of r^4" },
          { "r6", "1", -8.0, 8.0, 0.0, "of r^6" },
          { "tilt_x", "1", -1.0, 1.0, 0.0, "linear, to the right, per half diagonal" },
          { "tilt_y", "1", -1.0, 1.0, 0.0, "linear, downwards, per half diagonal" },
          { "tilt_x_r2", "1", -2.0, 2.0, 0.0, "of r^2 times the way to the right" },
          { "tilt_y_r2", "1", -2.0, 2.0, 0.0, "of r^2 times the way downwards" } },
        "vignetting: loss of illumination towards the corners",
        "D. B. Goldman, IEEE Trans. PAMI 32(12), 2010 (even polynomial); the tilt: "
        "first and third order of a shift of its centre",
        predict
    };
}

} // namespace effects
} // namespace cg2raw

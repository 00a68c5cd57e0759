// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Fall-off that differs between colours: the angle at which light meets filters
/// and microlenses grows to the corners. Green is the reference; what it loses is
/// lens_shading's.
#include "color_shading.h"

#include "plane_rows.h"

#include <algorithm>

namespace cg2raw {

double color_shading_at(const Values& values, int color, double u, double v)
{
    constexpr std::size_t terms = 4; // of a colour
    if (color == 1)
        return 1.0;
    const double* const term = values.data() + std::size_t(color) / 2 * terms;
    const double square = u * u + v * v;
    const double gain
        = 1.0 + square * (term[0] + square * term[1]) + term[2] * u + term[3] * v;
    return std::max(0.0, gain);
}

namespace effects {
namespace {

void predict(Signal& signal, const Values& values)
{
    each_field_row(signal, [&](int row, const double* u, double v) {
        for (std::size_t plane : { 0, 2 }) {
            float* const pixels = signal.mean[plane].row(row);
            for (int col = 0; col < signal.mean[plane].width; ++col)
                pixels[col] *= float(color_shading_at(values, int(plane), u[col], v));
        }
    });
}

} // namespace

Effect color_shading()
{
    std::vector<Parameter> parameters;
    for (const std::string color : { "red", "blue" }) {
        parameters.push_back({ color + "_r2", "1", -2.0, 2.0, 0.0,
                               color + " against green, of r^2; r = 1 in the corner",
                               CfaRepeat::colors });
        parameters.push_back({ color + "_r4", "1", -2.0, 2.0, 0.0,
                               color + " against green, of r^4", CfaRepeat::colors });
        parameters.push_back({ color + "_x", "1", -1.0, 1.0, 0.0,
                               color + " to the right, per half diagonal",
                               CfaRepeat::colors });
        parameters.push_back({ color + "_y", "1", -1.0, 1.0, 0.0,
                               color + " downwards, per half diagonal",
                               CfaRepeat::colors });
    }
    return { "color_shading",
             Stage::optics,
             Pattern::none,
             parameters,
             "vignetting of red and blue that differs from green's",
             "P. B. Catrysse, X. Liu, A. El Gamal, Proc. SPIE 3965, 2000 (pixel "
             "vignetting)",
             predict };
}

} // namespace effects
} // namespace cg2raw

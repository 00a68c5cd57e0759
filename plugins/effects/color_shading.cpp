// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Fall-off that differs between colours: the angle at which light meets filters
/// and microlenses grows to the corners. Green is the reference; what it loses is
/// lens_shading's.
#include "cg2raw/effect.h"

#include "plane_rows.h"

#include <algorithm>

namespace cg2raw::effects {
namespace {

/// Parameters of a colour.
constexpr std::size_t terms = 4;

void expect(Signal& signal, const Values& values)
{
    each_field_row(signal, [&](int row, const double* u, double v) {
        for (std::size_t plane : { 0, 2 }) {
            const double* const term = values.data() + plane / 2 * terms;
            float* const pixels = signal.mean[plane].row(row);
            for (int col = 0; col < signal.mean[plane].width; ++col) {
                const double square = u[col] * u[col] + v * v;
                const double gain = 1.0 + square * (term[0] + square * term[1])
                    + term[2] * u[col] + term[3] * v;
                pixels[col] *= float(std::max(0.0, gain));
            }
        }
    });
}

} // namespace

Effect color_shading()
{
    std::vector<Parameter> parameters;
    for (const std::string color : { "red", "blue" }) {
        parameters.push_back({ color + "_r2", "1", -2.0, 2.0, 0.0,
                               color + " against green, of r^2; r = 1 in the corner" });
        parameters.push_back(
            { color + "_r4", "1", -2.0, 2.0, 0.0, color + " against green, of r^4" });
        parameters.push_back({ color + "_x", "1", -1.0, 1.0, 0.0,
                               color + " to the right, per half diagonal" });
        parameters.push_back({ color + "_y", "1", -1.0, 1.0, 0.0,
                               color + " downwards, per half diagonal" });
    }
    return { "color_shading",
             Stage::optics,
             Pattern::none,
             parameters,
             "fall-off of red and blue that differs from green's",
             "P. B. Catrysse, X. Liu, A. El Gamal, Proc. SPIE 3965, 2000 (pixel "
             "vignetting)",
             expect };
}

} // namespace cg2raw::effects

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Light that lens and camera body scatter: part of it over the whole frame, part
/// of it widely around its place.
#include "cg2raw/effect.h"

#include <algorithm>
#include <cmath>

namespace cg2raw::effects {
namespace {

/// Where a pixel lies between the centres of two neighbouring cells.
struct Between {
    int first, second;
    float weight; ///< of the second
};

Between cells_around(int pixel, int pixels, int cells)
{
    const double place = (pixel + 0.5) * cells / pixels - 0.5;
    const double inside = std::clamp(place, 0.0, cells - 1.0);
    const int first = int(inside);
    return { first, std::min(first + 1, cells - 1), float(inside - first) };
}

void add_glare(Signal& signal, std::size_t plane, float uniform, float wide)
{
    const GlareContext& glare_context = *signal.exposure.glare_context;
    const Size frame = signal.exposure.frame, cells = glare_context.cells;
    const float everywhere = uniform * float(glare_context.mean[plane]);
    const float kept = 1.0f - uniform - wide;
    for (int row = 0; row < signal.mean[plane].height; ++row) {
        const Between v
            = cells_around(signal.origin.row + row, frame.height, cells.height);
        const float* const upper
            = glare_context.wide[plane].data() + std::ptrdiff_t(v.first) * cells.width;
        const float* const lower
            = glare_context.wide[plane].data() + std::ptrdiff_t(v.second) * cells.width;
        float* const pixels = signal.mean[plane].row(row);
        for (int col = 0; col < signal.mean[plane].width; ++col) {
            const Between u
                = cells_around(signal.origin.col + col, frame.width, cells.width);
            const auto at = [&v, upper, lower](int cell) {
                return upper[cell] + v.weight * (lower[cell] - upper[cell]);
            };
            const float around = at(u.first) + u.weight * (at(u.second) - at(u.first));
            pixels[col] = kept * pixels[col] + (everywhere + wide * around);
        }
    }
}

void predict(Signal& signal, const Values& values)
{
    if (values[0] == 0.0 && values[1] == 0.0)
        return;
    if (!signal.exposure.glare_context)
        throw Error("effect veiling_glare needs the whole frame: apply it to one");
    for (std::size_t plane = 0; plane < 3; ++plane)
        add_glare(signal, plane, float(values[0]), float(values[1]));
}

} // namespace

Effect veiling_glare()
{
    Effect effect {
        "veiling_glare",
        Stage::optics,
        Pattern::none,
        { { "uniform", "1", -0.05, 0.5, 0.0,
            "part of the light spread over the frame" },
          { "wide", "1", -0.05, 0.5, 0.0,
            "part of it spread over a sixth of the frame's height" } },
        "scattered light: dark places are lifted by the frame's mean",
        "ISO 9358:1994 (veiling glare); J. J. McCann, A. Rizzi, J. Soc. Inf. Display "
        "15(9), 2007",
        predict
    };
    effect.needs_glare_context = true;
    return effect;
}

} // namespace cg2raw::effects

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Light and charge that reach a neighbouring pixel, hence one of another colour:
/// less sharp and less saturated.
#include "cg2raw/effect.h"

#include "multiversion.h"
#include "neighbours.h"

namespace cg2raw::effects {
namespace {

/// Parts that come from the pixels around.
struct Parts {
    float left, right, up, down;
};

CG2RAW_MULTIVERSION void mix_row(const float* above, const float* here,
                                 const float* below, const Parts& parts, int width,
                                 float* out)
{
    const auto [left, right, up, down] = parts;
    for (int col = 0; col < width; ++col) {
        const float x = here[col];
        const float across = left * (here[col - 1] - x) + right * (here[col + 1] - x);
        out[col] = x + (across + (up * (above[col] - x) + down * (below[col] - x)));
    }
}

void predict(Signal& signal, const Values& values)
{
    const Parts parts { float(values[0]), float(values[1]), float(values[2]),
                        float(values[3]) };
    const Plane<float>& mosaic = signal.mean[0];
    const Margined from(mosaic, 1);
    for (int row = 0; row < mosaic.height; ++row)
        mix_row(from.row(row - 1), from.row(row), from.row(row + 1), parts,
                mosaic.width, mosaic.row(row));
}

} // namespace

Effect crosstalk()
{
    std::vector<Parameter> parameters;
    constexpr std::pair<const char*, const char*> sides[]
        = { { "left", "to its left" },
            { "right", "to its right" },
            { "up", "above it" },
            { "down", "below it" } };
    for (const auto& [side, place] : sides) {
        parameters.push_back({ side, "1", -0.05, 0.3, 0.0, "" });
        parameters.back().meaning
            = std::string("share of a pixel's signal that is of the pixel ") + place;
    }
    return { "crosstalk",
             Stage::pixel,
             Pattern::none,
             parameters,
             "light and charge that reach the neighbouring pixels",
             "J. Li et al., IEEE Trans. Image Process. 18(12), 2009 (as a convolution)",
             predict,
             nullptr,
             1 };
}

} // namespace cg2raw::effects

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Noise reduction in the camera, before the RAW file: each pixel is blended with
/// the nearest ones of its colour in a Bayer CFA. Noise of neighbours correlates then.
#include "cg2raw/effect.h"

#include "multiversion.h"
#include "neighbours.h"

#include <limits>

namespace cg2raw::effects {
namespace {

constexpr int apart = 2; ///< pixels of a colour

/// Weights of the pixel itself, of each of the four beside it, of each diagonal one.
struct Weights {
    float here, beside, diagonal;
};

/// What lies above @p white was clipped before: it counts as white. Only where all that
/// is blended lies above does the excess stay, so that the result is clipped too.
CG2RAW_MULTIVERSION void blend_row(const float* above, const float* here,
                                   const float* below, const Weights& weights,
                                   float white, int width, float* out)
{
    const auto [own, beside, diagonal] = weights;
    const auto at
        = [white](const float* row, int col) { return std::min(row[col], white); };
    for (int col = 0; col < width; ++col) {
        const int left = col - apart, right = col + apart;
        const float four
            = (at(here, left) + at(here, right)) + (at(above, col) + at(below, col));
        const float corners = (at(above, left) + at(above, right))
            + (at(below, left) + at(below, right));
        float lowest
            = std::min({ here[col], here[left], here[right], above[col], below[col] });
        if (diagonal != 0.0f)
            lowest = std::min(
                { lowest, above[left], above[right], below[left], below[right] });
        out[col] = own * at(here, col) + (beside * four + diagonal * corners)
            + std::max(lowest - white, 0.0f);
    }
}

void blend(const Plane<float>& plane, const Weights& weights, float white)
{
    if (weights.beside == 0.0f && weights.diagonal == 0.0f)
        return;
    const Margined from(plane, apart);
    for (int row = 0; row < plane.height; ++row)
        blend_row(from.row(row - apart), from.row(row), from.row(row + apart), weights,
                  white, plane.width, plane.row(row));
}

Weights weights_of(const Values& values)
{
    return { float(1.0 - values[0] - values[1]), float(values[0] / 4.0),
             float(values[1] / 4.0) };
}

/// Of independent neighbours: at the frame's edges, where the mirror image doubles one,
/// the variance is a little more. That of what the ADC clipped is left as it was.
void predict(Signal& signal, const Values& values)
{
    const auto [own, beside, diagonal] = weights_of(values);
    blend(signal.mean[0], { own, beside, diagonal }, 1.0f);
    blend(signal.variance, { own * own, beside * beside, diagonal * diagonal },
          std::numeric_limits<float>::max());
}

void draw(Signal& signal, const Values& values, const Rng&)
{
    blend(signal.mean[0], weights_of(values), 1.0f);
}

} // namespace

Effect noise_reduction()
{
    return {
        "noise_reduction",
        Stage::processing,
        Pattern::none,
        { { "blend", "1", -0.05, 0.9, 0.0,
            "part that comes from the four of the colour beside", CfaRepeat::bayer },
          { "diagonal", "1", -0.1, 0.4, 0.0,
            "part that comes from the four of the colour across", CfaRepeat::bayer } },
        "noise reduction before the file: noise of one colour's neighbours "
        "correlates",
        "J.-S. Lee, IEEE Trans. PAMI 2(2), 1980 (local statistics; here fixed)",
        predict,
        draw,
        apart
    };
}

} // namespace cg2raw::effects

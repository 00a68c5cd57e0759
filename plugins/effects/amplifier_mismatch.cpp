// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Halves of the frame that are read by amplifiers of their own. An amplifier
/// acts on light and charge with their noise: by its name the effect is the first of
/// its stage, and what others of the read-out add is not amplified.
#include "cg2raw/effect.h"

#include <algorithm>

namespace cg2raw::effects {
namespace {

/// What one amplifier does, against the mean of all.
struct Amplifier {
    float offset, response;
};

void amplify(const Signal& signal, int row, int first, int last, const Amplifier& by)
{
    const float factor = 1.0f + by.response;
    const float* const mean = signal.mean[0].row(row);
    float* const noise = signal.noise.row(row);
    float* const variance = signal.variance.row(row);
    for (int col = first; col < last; ++col) {
        noise[col] = noise[col] * factor + (mean[col] * by.response + by.offset);
        variance[col] *= factor * factor;
    }
}

void predict(Signal& signal, const Values& values)
{
    const auto [width, height] = signal.exposure.frame;
    const int columns = signal.noise.width;
    const int middle = std::clamp(width / 2 - signal.origin.col, 0, columns);
    for (int row = 0; row < signal.noise.height; ++row) {
        const double down = signal.origin.row + row < height / 2 ? -0.5 : 0.5;
        const auto amplifier = [&](double across) {
            return Amplifier { float(across * values[0] + down * values[1]),
                               float(across * values[2] + down * values[3]) };
        };
        amplify(signal, row, 0, middle, amplifier(-0.5));
        amplify(signal, row, middle, columns, amplifier(0.5));
    }
}

void draw(Signal& signal, const Values& values, const Rng&) { predict(signal, values); }

} // namespace

Effect amplifier_mismatch()
{
    return {
        "amplifier_mismatch",
        Stage::readout,
        Pattern::none,
        { { "horizontal_offset", "1", -0.5, 0.5, 0.0,
            "black level of the right half less that of the left" },
          { "vertical_offset", "1", -0.5, 0.5, 0.0,
            "black level of the lower half less that of the upper" },
          { "horizontal_response", "1", -0.5, 0.5, 0.0,
            "response of the right half less that of the left, relative" },
          { "vertical_response", "1", -0.5, 0.5, 0.0,
            "response of the lower half less that of the upper, relative" } },
        "halves of the frame, or quarters, that differ as their amplifiers do",
        "J. R. Janesick, Scientific Charge-Coupled Devices, 2001 (several outputs)",
        predict,
        draw
    };
}

} // namespace cg2raw::effects

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file A pedestal that is not level: a ramp over the frame, and first columns that
/// settle after the line's start. As all of the read-out it does not fall on what was
/// clipped.
#include "cg2raw/effect.h"

#include "elementary.h"

namespace cg2raw::effects {
namespace {

/// Columns of an edge beyond which nothing of it is left in float32.
constexpr double most_lengths = 100.0;

/// What the edge adds to a column, of a frame's first one.
double edge_at(const Values& values, int col)
{
    const double edge = values[2], length = values[3];
    if (edge == 0.0 || !(col < most_lengths * length))
        return 0.0;
    return edge * exponential(-col / length);
}

void predict(Signal& signal, const Values& values)
{
    const auto [width, height] = signal.exposure.frame;
    std::vector<float> of_column;
    for (int col = 0; col < signal.noise.width; ++col) {
        const int at = signal.origin.col + col;
        const double across = (at + 0.5) / width - 0.5;
        of_column.push_back(float(values[0] * across + edge_at(values, at)));
    }
    for (int row = 0; row < signal.noise.height; ++row) {
        const double down = (signal.origin.row + row + 0.5) / height - 0.5;
        const float of_row = float(values[1] * down);
        float* const noise = signal.noise.row(row);
        for (int col = 0; col < signal.noise.width; ++col)
            noise[col] += of_column[std::size_t(col)] + of_row;
    }
}

void draw(Signal& signal, const Values& values, const Rng&) { predict(signal, values); }

} // namespace

Effect bias_structure()
{
    return { "bias_structure",
             Stage::readout,
             Pattern::none,
             { { "horizontal", "1", -0.5, 0.5, 0.0,
                 "ramp: the right edge less the left one; 0 in the middle" },
               { "vertical", "1", -0.5, 0.5, 0.0,
                 "ramp: the bottom less the top; 0 in the middle" },
               { "edge", "1", -0.5, 0.5, 0.0, "offset of the first column" },
               { "edge_length", "px", 0.0, 1000.0, 0.0,
                 "columns over which it falls by a factor e; 0: there is no edge" } },
             "a black level that is not the same all over the frame",
             "J. R. Janesick, Scientific Charge-Coupled Devices, 2001",
             predict,
             draw };
}

} // namespace cg2raw::effects

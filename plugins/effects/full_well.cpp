// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file A full well below the ADC's white: signal and shot noise are cut before the
/// read-out adds its own.
#include "cg2raw/effect.h"

#include "elementary.h"

#include <algorithm>
#include <cmath>

namespace cg2raw::effects {
namespace {

/// Farther than this from the level, in standard deviations, less than 1e-16 of the
/// distribution lies on the other side.
constexpr double far = 8.0;

/// Mean and variance of min(X, level) for a normal X: with a = (mean - level) / sigma
/// those of the integrals of the normal density up to -a.
void clip(double level, float& mean, float& variance)
{
    const double sigma = std::sqrt(std::max(double(variance), 0.0));
    const double above = double(mean) - level;
    if (above <= -far * sigma)
        return;
    if (above >= far * sigma) {
        mean = float(level);
        variance = 0.0f;
        return;
    }
    const double a = above / sigma;
    constexpr double root_half = 0.70710678118654752, root_2_pi = 2.5066282746310002;
    const double density = exponential(-0.5 * a * a) / root_2_pi;
    const double below = 0.5 * std::erfc(a * root_half);
    const double shortfall = density - a * below; // of the mean, in sigma
    const double square = (1.0 + a * a) * below - a * density;
    mean = float(level - sigma * shortfall);
    variance = float(std::max(0.0, square - shortfall * shortfall) * sigma * sigma);
}

void predict(Signal& signal, const Values& values)
{
    if (values[0] == 0.0)
        return;
    for (int row = 0; row < signal.mean[0].height; ++row) {
        float* const mean = signal.mean[0].row(row);
        float* const variance = signal.variance.row(row);
        for (int col = 0; col < signal.mean[0].width; ++col)
            clip(1.0 - values[0], mean[col], variance[col]);
    }
}

void draw(Signal& signal, const Values& values, const Rng&)
{
    if (values[0] == 0.0)
        return;
    const float level = float(1.0 - values[0]);
    for (int row = 0; row < signal.mean[0].height; ++row) {
        float* const mean = signal.mean[0].row(row);
        for (int col = 0; col < signal.mean[0].width; ++col)
            mean[col] = std::min(mean[col], level);
    }
}

} // namespace

Effect full_well()
{
    return { "full_well",
             Stage::saturation,
             Pattern::none,
             { { "below_white", "1", 0.0, 0.95, 0.0,
                 "distance from the full well to white" } },
             "a full well below white: signal and shot noise are cut at its level",
             "A. Foi, Signal Processing 89(12), 2009 (clipped noisy data)",
             predict,
             draw };
}

} // namespace cg2raw::effects

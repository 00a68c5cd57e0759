// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Dust on the cover glass: soft dark spots at places of the sensor's own. They
/// are drawn in cells of a coarse grid, each with a row of uniforms: how many spots,
/// and where and how dark each is, so that blocks agree on them.
#include "cg2raw/effect.h"

#include "elementary.h"

#include <algorithm>
#include <cmath>

namespace cg2raw::effects {
namespace {

constexpr int cell = 32; ///< pixels a side
constexpr int most_spots
    = 40; ///< in a cell; of 10 on average, all but 1e-12 have fewer
constexpr double pixels_of_megapixel = 1e6;
/// Radii from a spot's centre where its loss, 2^-(r / radius)^2, is below 2^-16.
constexpr double reach = 4.0;
constexpr double largest_radius = 64.0;
constexpr int most_around = int(reach * largest_radius) / cell; ///< a frame, in cells
constexpr double ln_2 = 0.6931471805599453;

/// Of one spot; its depth is even between half the mean one and half as much again.
struct Spot {
    double row, col, depth;
};

/// Calls work(Spot) for the spots of a cell.
template <class Work>
void each_spot(int cell_row, int cell_col, const Values& values, const Rng& rng,
               const Work& work)
{
    const double expected = values[0] * cell * cell / pixels_of_megapixel;
    double uniform[4 * most_spots];
    rng.uniforms({ cell_row + most_around, 4 * most_spots * (cell_col + most_around) },
                 4 * most_spots, uniform);
    // Uniforms are multiplied until they fall below e^-expected: a Poisson number.
    double product = uniform[0];
    const double least = exponential(-expected);
    for (int i = 0; i + 1 < most_spots && product > least; ++i) {
        const double* const own = uniform + std::ptrdiff_t(4) * i;
        work(Spot { (cell_row + own[1]) * cell, (cell_col + own[2]) * cell,
                    values[1] * (0.5 + own[3]) });
        product *= own[4];
    }
}

void shade(Signal& signal, const Spot& spot, double radius)
{
    const double far = reach * radius;
    const auto [width, height] = std::pair(signal.mean[0].width, signal.mean[0].height);
    const double top = spot.row - signal.origin.row,
                 left = spot.col - signal.origin.col;
    const int first = std::max(0, int(std::ceil(left - far)));
    const int last = std::min(width - 1, int(std::floor(left + far)));
    for (int row = std::max(0, int(std::ceil(top - far)));
         row <= std::min(height - 1, int(std::floor(top + far))); ++row) {
        float* const mean = signal.mean[0].row(row);
        const double down = (row - top) * (row - top);
        for (int col = first; col <= last; ++col) {
            const double square = down + (col - left) * (col - left);
            const double loss
                = spot.depth * exponential(-ln_2 * square / (radius * radius));
            mean[col] *= float(std::max(0.0, 1.0 - loss));
        }
    }
}

void predict(Signal&, const Values&) { }

void draw(Signal& signal, const Values& values, const Rng& rng)
{
    const double radius = values[2];
    if (values[0] == 0.0 || values[1] == 0.0)
        return;
    const int around = int(std::ceil(reach * radius / cell));
    const auto [row, col] = signal.origin;
    const int last_row = (row + signal.mean[0].height - 1) / cell + around;
    const int last_col = (col + signal.mean[0].width - 1) / cell + around;
    for (int r = row / cell - around; r <= last_row; ++r)
        for (int c = col / cell - around; c <= last_col; ++c)
            each_spot(r, c, values, rng,
                      [&](const Spot& spot) { shade(signal, spot, radius); });
}

} // namespace

Effect dust()
{
    return { "dust",
             Stage::pixel,
             Pattern::fixed,
             { { "density", "1/MP", 0.0, 10000.0, 0.0, "spots per million pixels" },
               { "depth", "1", 0.0, 0.6, 0.0,
                 "mean loss of light in the middle of a spot" },
               { "radius", "px", 1.0, largest_radius, 1.0,
                 "from the middle to where half the loss is left" } },
             "dust: soft dark spots, the same in every frame",
             "R. Willson et al., An Optical Model for Image Artifacts Produced by Dust "
             "Particles "
             "on Lenses, i-SAIRAS 2005",
             predict,
             draw };
}

} // namespace cg2raw::effects

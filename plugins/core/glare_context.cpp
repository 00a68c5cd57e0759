// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Sums are of float64 in a fixed order.
#include "cg2raw/glare_context.h"

#include "elementary.h"

#include <algorithm>
#include <cmath>

namespace cg2raw {
namespace {

constexpr int cells_across = 64;
/// Where the Gaussian is cut, in sigmas.
constexpr double cut = 4.0;

Size cells_of(Size frame)
{
    const int across = std::min(cells_across, frame.width);
    const double cell = double(frame.width) / across;
    return { across,
             std::clamp(int(std::floor(frame.height / cell + 0.5)), 1, frame.height) };
}

/// First pixel of cell @p i of @p cells.
int edge(int i, int cells, int pixels) { return int(std::int64_t(i) * pixels / cells); }

/// Sums of the cells' pixels.
std::vector<double> cell_sums(const Plane<const float>& plane, Size cells)
{
    std::vector<double> sums(std::size_t(cells.width) * std::size_t(cells.height));
    for (int y = 0; y < cells.height; ++y) {
        double* const of_row = sums.data() + std::ptrdiff_t(y) * cells.width;
        const int end = edge(y + 1, cells.height, plane.height);
        for (int row = edge(y, cells.height, plane.height); row < end; ++row)
            for (int x = 0; x < cells.width; ++x) {
                const int last = edge(x + 1, cells.width, plane.width);
                for (int col = edge(x, cells.width, plane.width); col < last; ++col)
                    of_row[x] += double(plane.row(row)[col]);
            }
    }
    return sums;
}

/// Weights of offsets 0, 1 ... of a Gaussian; with both sides they sum to 1.
std::vector<double> gaussian(double sigma)
{
    std::vector<double> weights;
    double sum = 0.0;
    for (int i = 0; i <= int(cut * sigma); ++i) {
        weights.push_back(exponential(-0.5 * i * i / (sigma * sigma)));
        sum += (i ? 2.0 : 1.0) * weights.back();
    }
    for (double& weight : weights)
        weight /= sum;
    return weights;
}

/// Index of the cell seen at @p i when the line of cells is mirrored at both ends.
int mirrored(int i, int count)
{
    const int period = 2 * count;
    const int at = (i % period + period) % period;
    return at < count ? at : period - 1 - at;
}

/// Spreads along one direction: cells @p step apart.
void spread(std::vector<double>& cells, int count, int step, int lines, int line_step,
            double sigma)
{
    const std::vector<double> weights = gaussian(sigma);
    const int radius = int(weights.size()) - 1;
    std::vector<int> places; // of the line and what is mirrored at its ends
    for (int i = -radius; i < count + radius; ++i)
        places.push_back(mirrored(i, count) * step);
    std::vector<double> line(places.size());
    for (int start = 0; start < lines; ++start) {
        double* const first = cells.data() + std::ptrdiff_t(start) * line_step;
        for (std::size_t i = 0; i < places.size(); ++i)
            line[i] = first[places[i]];
        for (int i = 0; i < count; ++i) {
            const double* const here = line.data() + radius + i;
            double sum = weights[0] * here[0];
            for (int k = 1; k <= radius; ++k)
                sum += weights[std::size_t(k)] * (here[-k] + here[k]);
            first[std::ptrdiff_t(i) * step] = sum;
        }
    }
}

} // namespace

GlareContext glare_context_of(const std::array<Plane<const float>, 3>& camera)
{
    const Size frame { camera[0].width, camera[0].height };
    const Size cells = cells_of(frame);
    const double across = double(frame.width) / cells.width;
    const double down = double(frame.height) / cells.height;
    const double sigma = frame.height / 6.0;
    GlareContext glare_context { cells, {}, {} };
    for (std::size_t plane = 0; plane < 3; ++plane) {
        std::vector<double> values = cell_sums(camera[plane], cells);
        double sum = 0.0;
        for (double value : values)
            sum += value;
        glare_context.mean[plane] = sum / (double(frame.width) * double(frame.height));
        for (int y = 0; y < cells.height; ++y)
            for (int x = 0; x < cells.width; ++x) {
                const double rows = edge(y + 1, cells.height, frame.height)
                    - edge(y, cells.height, frame.height);
                const double cols = edge(x + 1, cells.width, frame.width)
                    - edge(x, cells.width, frame.width);
                values[std::size_t(y * cells.width + x)] /= rows * cols;
            }
        spread(values, cells.width, 1, cells.height, cells.width, sigma / across);
        spread(values, cells.height, cells.width, cells.width, 1, sigma / down);
        glare_context.wide[plane].assign(values.begin(), values.end());
    }
    return glare_context;
}

} // namespace cg2raw

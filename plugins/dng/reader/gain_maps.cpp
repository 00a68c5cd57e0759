// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What GainMaps say at a place. Source: DNG specification 1.7.1, "GainMap".
#include "reader/gain_maps.h"
#include "reader/profile_parts.h"

#include <algorithm>
#include <cmath>

namespace cg2raw {
namespace {

/// A gain of so much restores nothing: our own writer stops at 1000.
constexpr double hopeless_gain = 999.0;

double gain_at(const GainMapAt& map, Place at)
{
    const auto between = [](double position, int points) {
        return std::clamp(position, 0.0, double(points - 1));
    };
    const double v = between((at.v - map.origin_v) / map.spacing_v, map.map.rows);
    const double h = between((at.h - map.origin_h) / map.spacing_h, map.map.cols);
    const int row = int(v), col = int(h);
    const int below = std::min(row + 1, map.map.rows - 1);
    const int right = std::min(col + 1, map.map.cols - 1);
    const auto gain = [&](int r, int c) {
        return double(
            map.map.gains[std::size_t(r) * std::size_t(map.map.cols) + std::size_t(c)]);
    };
    const double top = gain(row, col) + (h - col) * (gain(row, right) - gain(row, col));
    const double bottom
        = gain(below, col) + (h - col) * (gain(below, right) - gain(below, col));
    return top + (v - row) * (bottom - top);
}

Place place_on(const GainMapAt& grid, int row, int col)
{
    return { grid.origin_v + row * grid.spacing_v,
             grid.origin_h + col * grid.spacing_h };
}

std::array<int, 3> color_counts(const CfaPattern& cfa)
{
    std::array<int, 3> counts {};
    for (int site = 0; site < cfa.sites(); ++site)
        ++counts[cfa.colors[std::size_t(site)]];
    return counts;
}

/// Calls @p visit with each point of @p map that lies in the frame.
template <class Visit> void each_point(const GainMapAt& map, const Visit& visit)
{
    constexpr double rounding = 1e-9;
    for (int row = 0; row < map.map.rows; ++row)
        for (int col = 0; col < map.map.cols; ++col) {
            const Place at = place_on(map, row, col);
            if (at.v >= -rounding && at.v <= 1 + rounding && at.h >= -rounding
                && at.h <= 1 + rounding)
                visit(row, col, at);
        }
}

/// Means over the sites of R, G, B; sums of none are 0.
Vec3 color_means(const CfaPattern& cfa, const SiteGains& values)
{
    Vec3 means {};
    const std::array<int, 3> counts = color_counts(cfa);
    for (int site = 0; site < cfa.sites(); ++site) {
        const std::size_t color = cfa.colors[std::size_t(site)];
        means[color] += values[std::size_t(site)] / counts[color];
    }
    return means;
}

/// What one file's maps say at a place.
struct FileShading {
    double mean; ///< over the sites
    double red, blue; ///< over green
};

/// Means over the sites, nothing where one is hopeless; adds the squares of their
/// departures to @p squares.
std::optional<FileShading> mean_shading(const DngMetadata& file, Place at,
                                        double& squares)
{
    const int sites = file.cfa.sites();
    const SiteGains gains = site_gains(file, at, gain_at);
    SiteGains shading {};
    double mean = 0.0;
    for (int site = 0; site < sites; ++site) {
        const double gain = gains[std::size_t(site)];
        if (gain >= hopeless_gain)
            return std::nullopt;
        shading[std::size_t(site)] = 1.0 / gain;
        mean += shading[std::size_t(site)] / sites;
    }
    for (int site = 0; site < sites; ++site) {
        const double departure = shading[std::size_t(site)] / mean - 1.0;
        squares += departure * departure / sites;
    }
    const Vec3 colors = color_means(file.cfa, shading);
    return FileShading { mean, colors[0] / colors[1], colors[2] / colors[1] };
}

} // namespace

bool covers(const GainMapAt& map, Place at, Size size)
{
    // A map of one site starts and ends a pixel inside.
    const double row = at.v * size.height, col = at.h * size.width;
    return row >= map.top - map.row_pitch && row <= map.bottom + map.row_pitch
        && col >= map.left - map.col_pitch && col <= map.right + map.col_pitch;
}

Place place_of(const GainMapSamples& samples, const ShadingAt& point)
{
    return place_on(*samples.grid, point.row, point.col);
}

double green_shading(const GainMapSamples& samples, const ShadingAt& point)
{
    const auto [reds, greens, blues] = color_counts(samples.cfa);
    const double over_green
        = (reds * double(point.red) + greens + blues * double(point.blue))
        / samples.cfa.sites();
    return point.shading / over_green;
}

GainMapSamples gain_map_samples(const std::vector<const DngMetadata*>& files)
{
    const GainMapAt& grid = files.front()->gain_maps.front();
    GainMapSamples samples;
    samples.grid = &grid;
    samples.cfa = files.front()->cfa;
    samples.points.reserve(grid.map.gains.size());
    double site_squares = 0.0, file_squares = 0.0;
    std::vector<double> shading(files.size()), red = shading, blue = shading;
    each_point(grid, [&](int row, int col, Place at) {
        for (std::size_t i = 0; i < files.size(); ++i) {
            const auto one = mean_shading(*files[i], at, site_squares);
            if (!one)
                return;
            shading[i] = one->mean;
            red[i] = one->red;
            blue[i] = one->blue;
        }
        const double mean = mean_of(shading);
        for (double value : shading)
            file_squares += (value / mean - 1.0) * (value / mean - 1.0);
        samples.points.push_back(
            { row, col, mean, float(mean_of(red)), float(mean_of(blue)) });
    });
    const double count = double(std::max<std::size_t>(1, samples.points.size()))
        * double(files.size());
    samples.between_sites = std::sqrt(site_squares / count);
    samples.between_files = std::sqrt(file_squares / count);
    return samples;
}

} // namespace cg2raw

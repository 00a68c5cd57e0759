// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What GainMaps say at a place. Source: DNG specification 1.7.1, "GainMap".
#include "dng_reader_gain_maps.h"
#include "dng_reader_parts.h"

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

/// Within a step of the pitch: a map of one site starts and ends a pixel inside.
bool covers(const GainMapAt& map, Place at, Size size)
{
    const double row = at.v * size.height, col = at.h * size.width;
    return row >= map.top - map.row_pitch && row <= map.bottom + map.row_pitch
        && col >= map.left - map.col_pitch && col <= map.right + map.col_pitch;
}

using SiteGains = std::array<double, 36>;

/// The product of all gains that each site of the CFA gets at a place; each map is
/// looked up once, as a file may have many sites and maps.
SiteGains site_gains(const DngMetadata& file, Place at)
{
    SiteGains gains;
    gains.fill(1.0);
    for (const GainMapAt& map : file.gain_maps) {
        if (!covers(map, at, file.active_area))
            continue;
        const double gain = gain_at(map, at);
        for (int site : map.sites)
            gains[std::size_t(site)] *= gain;
    }
    return gains;
}

/// Calls @p visit with each point of @p map that lies in the frame.
template <class Visit> void each_point(const GainMapAt& map, const Visit& visit)
{
    constexpr double rounding = 1e-9;
    for (int row = 0; row < map.map.rows; ++row)
        for (int col = 0; col < map.map.cols; ++col) {
            const Place at { map.origin_v + row * map.spacing_v,
                             map.origin_h + col * map.spacing_h };
            if (at.v >= -rounding && at.v <= 1 + rounding && at.h >= -rounding
                && at.h <= 1 + rounding)
                visit(at);
        }
}

/// Mean over the sites, 0 where one is hopeless; adds the squares of their departures
/// to @p squares.
double mean_shading(const DngMetadata& file, Place at, double& squares)
{
    const int sites = file.cfa.sites();
    const SiteGains gains = site_gains(file, at);
    SiteGains shading {};
    double mean = 0.0;
    for (int site = 0; site < sites; ++site) {
        const double gain = gains[std::size_t(site)];
        if (gain >= hopeless_gain)
            return 0.0;
        shading[std::size_t(site)] = 1.0 / gain;
        mean += shading[std::size_t(site)] / sites;
    }
    for (int site = 0; site < sites; ++site) {
        const double departure = shading[std::size_t(site)] / mean - 1.0;
        squares += departure * departure / sites;
    }
    return mean;
}

} // namespace

GainMapSamples gain_map_samples(const std::vector<const DngMetadata*>& files)
{
    const GainMapAt& grid = files.front()->gain_maps.front();
    GainMapSamples samples;
    samples.points.reserve(grid.map.gains.size());
    double site_squares = 0.0, file_squares = 0.0;
    std::vector<double> shading(files.size());
    each_point(grid, [&](Place at) {
        for (std::size_t i = 0; i < files.size(); ++i)
            shading[i] = mean_shading(*files[i], at, site_squares);
        if (std::find(shading.begin(), shading.end(), 0.0) != shading.end())
            return;
        const double mean = mean_of(shading);
        for (double value : shading)
            file_squares += (value / mean - 1.0) * (value / mean - 1.0);
        samples.points.push_back({ at, mean });
    });
    const double count = double(std::max<std::size_t>(1, samples.points.size()))
        * double(files.size());
    samples.between_sites = std::sqrt(site_squares / count);
    samples.between_files = std::sqrt(file_squares / count);
    return samples;
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Samples and lines that the parts of darks and flats do not describe: hot
/// pixels, cosmic rays, dead lines.
#include "cg2raw/frame_statistics.h"

#include "lanes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <mutex>

namespace cg2raw {
namespace {

constexpr double point_sigmas = 8.0; ///< of a million normal samples, none is so far
constexpr double line_sigmas = 10.0;
constexpr double least_sigma = 0.25; ///< steps of codes; less is hidden by rounding
constexpr int median_reach
    = 4; ///< lines on either side that tell what a line should be
constexpr std::size_t most_of_spread = 1 << 18; ///< samples tell the spread of all
constexpr double spread_sigmas = 5.0;
constexpr int spread_rounds = 5;
/// Of fills: what is 8 deviations off is by a hundredth of one more or less.
constexpr int rough_rounds = 4;

/// Mean and standard deviation without what is beyond 5 of them. Codes may be few, so
/// that ranks would not tell.
struct Spread {
    double mean, sigma;
};

Spread spread_of(std::vector<double> sample)
{
    Spread found {};
    for (int round = 0; round < spread_rounds && !sample.empty(); ++round) {
        const double count = double(sample.size());
        found.mean = total(sample.data(), int(sample.size())) / count;
        double squares = 0.0;
        for (const double value : sample)
            squares += (value - found.mean) * (value - found.mean);
        found.sigma = std::sqrt(squares / count);
        const auto far
            = std::remove_if(sample.begin(), sample.end(), [&](double value) {
                  return std::abs(value - found.mean) >= spread_sigmas * found.sigma;
              });
        if (found.sigma == 0.0 || far == sample.end())
            break;
        sample.erase(far, sample.end());
    }
    return found;
}

/// From each sample of a plane that tells their spread to the next.
std::size_t step_of_spread(const PlaneParts& plane)
{
    return std::size_t(plane.samples()) / most_of_spread + 1;
}

/// The mean range of @p count standard normal numbers.
double mean_range(int count)
{
    constexpr int reach = 8 * 64;
    constexpr double step = 1.0 / 64.0;
    double sum = 0.0;
    for (int i = -reach; i < reach; ++i) {
        const double below = 0.5 * std::erfc(-i * step / std::sqrt(2.0));
        sum += 1.0 - std::pow(below, count) - std::pow(1.0 - below, count);
    }
    return sum * step;
}

/// The medians of those around each line, which mirror at the ends.
std::vector<double> running_median(const std::vector<double>& profile)
{
    const int count = int(profile.size()), period = std::max(2 * (count - 1), 1);
    std::vector<double> found, near;
    for (int line = 0; line < count; ++line) {
        near.clear();
        for (int at = line - median_reach; at <= line + median_reach; ++at) {
            const int place = (at % period + period) % period;
            near.push_back(profile[std::size_t(std::min(place, period - place))]);
        }
        const auto middle = near.begin() + median_reach;
        std::nth_element(near.begin(), middle, near.end());
        found.push_back(*middle);
    }
    return found;
}

/// How far a running median of @p profile may be off at each line for a slope: it
/// mirrors at the ends, by as many of the steps that are usual there as are missing.
std::vector<double> flattened(const std::vector<double>& profile)
{
    const int count = int(profile.size());
    std::vector<double> steps;
    for (int line = 0; line + 1 < count; ++line)
        steps.push_back(
            std::abs(profile[std::size_t(line + 1)] - profile[std::size_t(line)]));
    steps.push_back(steps.empty() ? 0.0 : steps.back());
    auto found = running_median(steps);
    for (int line = 0; line < count; ++line) {
        const int to_end = std::min(line, count - 1 - line);
        found[std::size_t(line)] *= std::max(median_reach - to_end, 0);
    }
    return found;
}

/// The lines whose means stand out of those around, once polynomials are taken off,
/// which the running median shows without them. @p samples: of each line.
/// @p least: sigma of a sample.
std::vector<std::uint8_t> lines_that_stand_out(std::vector<double> sums, double samples,
                                               const Polynomials& low, double least)
{
    for (double& sum : sums)
        sum /= samples;
    const auto slack = flattened(sums);
    const auto clean = running_median(sums);
    const double mean = total(clean.data(), low.length()) / low.length();
    for (double& value : sums)
        value -= mean;
    for (int k = 1; k <= low.degree(); ++k) {
        const double found = dot(clean.data(), low.of(k), low.length());
        for (int i = 0; i < low.length(); ++i)
            sums[std::size_t(i)] -= found * low.of(k)[i];
    }
    const auto around = running_median(sums);
    std::transform(sums.begin(), sums.end(), around.begin(), sums.begin(),
                   std::minus<>());
    const double most
        = line_sigmas * std::max(spread_of(sums).sigma, least / std::sqrt(samples));
    std::vector<std::uint8_t> found;
    for (std::size_t i = 0; i < sums.size(); ++i)
        found.push_back(std::uint8_t(std::abs(sums[i]) > most + slack[i]));
    return found;
}

} // namespace

/// Marks what one of several frames has alone, cosmic rays or flicker, and puts the
/// others' mean there, each about its own level.
void FrameStatistics::finish_look(const ParallelFor& parallel)
{
    Look& look = m_looks[std::size_t(m_current)];
    const double frames = m_groups[std::size_t(m_current)].frames;
    if (frames < 2)
        return;
    const double range = mean_range(int(look.levels.size()));
    const double others = std::sqrt((frames - 1.0) / frames);
    std::vector<std::vector<Transient>> found(m_planes.size());
    parallel(int(m_planes.size()), [&](int p) {
        const PlaneParts& plane = m_planes[std::size_t(p)];
        std::int64_t offset = 0;
        for (const auto& levels : look.levels)
            offset += levels[std::size_t(p)];
        const double level = double(offset) / frames;
        const auto each = [&](const auto& work) {
            for (int y = 0; y < plane.height(); ++y) {
                const Site first = plane.site(y, 0);
                std::size_t at = std::size_t(first.row) * std::size_t(m_size.width)
                    + std::size_t(first.col);
                for (int x = 0; x < plane.width(); ++x, at += std::size_t(plane.side))
                    work(at);
            }
        };
        std::vector<double> ranges;
        const std::size_t every = step_of_spread(plane);
        std::size_t number = 0;
        each([&](std::size_t at) {
            if (number++ % every == 0)
                ranges.push_back(double(m_highest[at]) - m_lowest[at]);
        });
        const double sigma
            = std::max(spread_of(std::move(ranges)).mean / range, least_sigma * m_step);
        const double most = point_sigmas * sigma * others;
        each([&](std::size_t at) {
            const double mean = double(look.sum[at]) / frames - level;
            const double above = m_highest[at] - mean, below = mean - m_lowest[at];
            if (std::max(above, below) <= most)
                return;
            m_marked[at] = 1;
            const std::int16_t own = above >= below ? m_highest[at] : m_lowest[at];
            if (!m_uncounted[at])
                found[std::size_t(p)].push_back(
                    { std::uint32_t(at), own, above >= below });
            const double rest = (mean * frames - own) / (frames - 1.0);
            look.sum[at] = std::uint32_t(std::max(rest + level, 0.0) * frames + 0.5);
        });
    });
    for (const auto& of_plane : found)
        look.transients.insert(look.transients.end(), of_plane.begin(), of_plane.end());
}

void FrameStatistics::mask(const ParallelFor& parallel)
{
    finish_look(parallel);
    m_highest = {};
    m_lowest = {};
    // Groups side by side; planes, of which there may be one, where there is one group.
    const ParallelFor serial = parallel_threads(1);
    const int groups = int(m_groups.size());
    const ParallelFor& by_group = groups > 1 ? parallel : serial;
    const ParallelFor& within = groups > 1 ? serial : parallel;
    std::mutex marking;
    by_group(groups, [&](int group) {
        const auto points = outliers(group, within);
        const std::lock_guard guard(marking);
        std::transform(points.begin(), points.end(), m_marked.begin(), m_marked.begin(),
                       std::bit_or<>());
    });
    m_masks.resize(m_planes.size());
    parallel(int(m_planes.size()), [&](int p) {
        m_masks[std::size_t(p)]
            = mask_of(m_planes[std::size_t(p)], m_marked.data(), m_size.width);
    });
    by_group(groups, [&](int group) {
        Look& look = m_looks[std::size_t(group)];
        GroupSums& sums = m_groups[std::size_t(group)];
        std::vector<double> base(look.base);
        for (double& value : base)
            value *= sums.frames;
        auto means = sums_of(sum_of(group), m_planes, base, within);
        look.filled.resize(m_planes.size());
        within(int(m_planes.size()), [&](int p) {
            const auto at = std::size_t(p);
            means[at].scale(1.0 / sums.frames);
            const PlaneParts& plane = m_planes[at];
            look.filled[at] = fill(
                plane, m_masks[at],
                [&](int y, int x) {
                    return sum_of(group)(plane.site(y, x)) / double(sums.frames)
                        - look.base[at];
                },
                means[at]);
            for (std::size_t i = 0; i < m_masks[at].samples.size(); ++i) {
                const auto place = int(m_masks[at].samples[i]);
                const Site site
                    = plane.site(place / plane.width(), place % plane.width());
                sums.planes[at].masked.push_back(sum_of(group)(site)
                                                     / double(sums.frames)
                                                 - look.base[at] - look.filled[at][i]);
            }
            sums.planes[at].base = look.base[at];
            sums.planes[at].mean = std::move(means[at]);
        });
    });
}

/// Of the mean of a group: points beyond what the other parts say, then lines. What is
/// among them is no transient.
std::vector<std::uint8_t> FrameStatistics::outliers(int group,
                                                    const ParallelFor& parallel)
{
    Look& look = m_looks[std::size_t(group)];
    const int frames = m_groups[std::size_t(group)].frames;
    if (frames == 0)
        throw Error("group " + std::to_string(group) + " has no frame");
    std::vector<double> base(look.base);
    for (double& value : base)
        value *= frames;
    const auto raw = sums_of(sum_of(group), m_planes, base, parallel);
    std::vector<std::uint8_t> points(m_excluded);
    parallel(int(m_planes.size()), [&](int p) {
        const auto number = std::size_t(p);
        const PlaneParts& plane = m_planes[number];
        const auto sample = [&](int y, int x) {
            return sum_of(group)(plane.site(y, x)) / double(frames) - look.base[number];
        };
        PlaneSums sums;
        for (int round = 0; round < 3; ++round) { // twice points; then lines
            sums = raw[number];
            sums.scale(1.0 / frames);
            fill(plane, mask_of(plane, points.data(), m_size.width), sample, sums,
                 rough_rounds);
            if (round == 2)
                break;
            const SmoothRows smooth(plane, sums);
            std::vector<double> row, rest;
            const std::size_t every = step_of_spread(plane);
            std::size_t index = 0;
            for (int y = 0; y < plane.height(); ++y) {
                smooth.row(y, row);
                for (int x = 0; x < plane.width(); ++x)
                    if (index++ % every == 0)
                        rest.push_back(sample(y, x) - row[std::size_t(x)]);
            }
            const double most = point_sigmas
                * std::max(spread_of(std::move(rest)).sigma, least_sigma * m_step);
            for (int y = 0; y < plane.height(); ++y) {
                smooth.row(y, row);
                std::uint8_t* const marks = points.data()
                    + std::size_t(plane.first_row + y * plane.side)
                        * std::size_t(m_size.width)
                    + plane.first_col;
                const std::uint8_t* const excluded
                    = m_excluded.data() + (marks - points.data());
                for (int x = 0; x < plane.width(); ++x) {
                    const std::ptrdiff_t at = std::ptrdiff_t(x) * plane.side;
                    const bool is_far
                        = std::abs(sample(y, x) - row[std::size_t(x)]) > most;
                    marks[at] = excluded[at] | std::uint8_t(is_far);
                }
            }
        }
        const auto mark = [&](int y, int x) {
            points[std::size_t(plane.first_row + y * plane.side)
                       * std::size_t(m_size.width)
                   + std::size_t(plane.first_col + x * plane.side)]
                = 1;
        };
        const auto rows = lines_that_stand_out(sums.rows, plane.width(), plane.down,
                                               least_sigma * m_step);
        const auto columns = lines_that_stand_out(sums.columns, plane.height(),
                                                  plane.across, least_sigma * m_step);
        for (int y = 0; y < plane.height(); ++y)
            for (int x = 0; x < plane.width(); ++x)
                if (rows[std::size_t(y)] || columns[std::size_t(x)])
                    mark(y, x);
    });
    auto& alone = look.transients; // hot pixels are noisy in all frames
    alone.erase(std::remove_if(alone.begin(), alone.end(),
                               [&](const Transient& one) {
                                   return points[one.at] && !m_excluded[one.at];
                               }),
                alone.end());
    return points;
}

} // namespace cg2raw

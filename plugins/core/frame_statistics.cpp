// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/frame_statistics.h"

#include "lanes.h"
#include "multiversion.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <string>

namespace cg2raw {
namespace {

constexpr std::size_t codes = 1 << 16;
std::string size_text(Size size)
{
    return std::to_string(size.width) + " x " + std::to_string(size.height);
}

/// The block that a line is in: one ends where its share of the length does.
std::size_t block_of(int line, int length)
{
    return ((std::size_t(line) + 1) * statistics_blocks - 1) / std::size_t(length);
}

/// Words of 64 bits that a row of the mosaic takes.
std::size_t words_of(int width) { return (std::size_t(width) + 63) / 64; }

std::int16_t saturated(std::int32_t value)
{
    using Limits = std::numeric_limits<std::int16_t>;
    return std::int16_t(std::clamp<std::int32_t>(value, Limits::min(), Limits::max()));
}

/// Sums over pairs' residuals of one plane in a strip.
struct ResidualSums {
    double fourth = 0.0;
    std::array<std::int64_t, statistics_bins> counts {};
    std::array<double, statistics_blocks * statistics_blocks> noise {};
};

/// Sums of a strip of a pair.
struct PairStrip {
    std::vector<ResidualSums> planes;
    std::array<double, statistics_lags.size()> lags {};
};

CG2RAW_MULTIVERSION
void add_fourth_powers(const float* z, int count, double& sum)
{
    double sums[lanes] {};
    int i = 0;
    for (; i + lanes <= count; i += lanes)
        for (int lane = 0; lane < lanes; ++lane) {
            const double square = double(z[i + lane]) * double(z[i + lane]);
            sums[lane] += square * square;
        }
    for (; i < count; ++i)
        sums[0] += double(z[i]) * z[i] * z[i] * z[i];
    for (const double lane : sums)
        sum += lane;
}

CG2RAW_MULTIVERSION
double product(const float* a, const float* b, int count)
{
    double sums[lanes] {};
    int i = 0;
    for (; i + lanes <= count; i += lanes)
        for (int lane = 0; lane < lanes; ++lane)
            sums[lane] += double(a[i + lane]) * double(b[i + lane]);
    for (; i < count; ++i)
        sums[0] += double(a[i]) * double(b[i]);
    return total(sums, lanes);
}

} // namespace

CodeCounts code_counts(const Plane<const std::uint16_t>& frame, int side,
                       const std::uint8_t* excluded, const ParallelFor& parallel)
{
    constexpr int shares = 2; // each has tables of its own
    std::array<CodeCounts, shares> parts;
    const auto repeat = std::size_t(side);
    parallel(shares, [&](int share) {
        CodeCounts& counts = parts[std::size_t(share)];
        counts.assign(repeat * repeat, std::vector<std::uint32_t>(codes));
        for (int r = frame.height * share / shares;
             r < frame.height * (share + 1) / shares; ++r) {
            const std::uint16_t* const row = frame.row(r);
            const std::size_t at = std::size_t(r) * std::size_t(frame.width);
            for (std::size_t q = 0; q < repeat; ++q) {
                auto& count = counts[std::size_t(r) % repeat * repeat + q];
                for (std::size_t c = q; c < std::size_t(frame.width); c += repeat)
                    count[row[c]] += excluded ? excluded[at + c] ^ 1U : 1U;
            }
        }
    });
    for (std::size_t p = 0; p < parts[0].size(); ++p)
        std::transform(parts[0][p].begin(), parts[0][p].end(), parts[1][p].begin(),
                       parts[0][p].begin(), std::plus<>());
    return std::move(parts[0]);
}

FrameStatistics::FrameStatistics(Size size, int side, int groups, int step)
    : m_size(size)
    , m_side(side)
    , m_step(step)
    , m_looks(std::size_t(std::max(groups, 0)))
    , m_groups(std::size_t(std::max(groups, 0)))
{
    if (step < 1)
        throw Error("step " + std::to_string(step) + " must be at least 1 DN");
    if (side < 1 || size.width < side || size.height < side)
        throw Error("frames are " + size_text(size)
                    + " pixels; must be at least as large as the CFA's repeat, "
                    + size_text({ side, side }));
    for (int r = 0; r < side; ++r)
        for (int c = 0; c < side; ++c)
            m_planes.push_back({ r, c, side,
                                 Polynomials((size.height - r + side - 1) / side),
                                 Polynomials((size.width - c + side - 1) / side) });
    m_marked.resize(std::size_t(size.width) * std::size_t(size.height));
    m_excluded.resize(m_marked.size());
    m_uncounted.resize(m_marked.size());
    for (GroupSums& group : m_groups)
        group.planes.resize(m_planes.size());
}

Plane<const std::uint32_t> FrameStatistics::sum_of(int group) const
{
    return { m_looks[std::size_t(group)].sum.data(), m_size.width, m_size.height,
             m_size.width };
}

void FrameStatistics::check_size(const Plane<const std::uint16_t>& frame) const
{
    if (frame.width != m_size.width || frame.height != m_size.height)
        throw Error("frame is " + size_text({ frame.width, frame.height })
                    + " pixels, the first " + size_text(m_size));
}

CodeCounts FrameStatistics::look(int group, const Plane<const std::uint16_t>& frame,
                                 const ParallelFor& parallel)
{
    check_size(frame);
    if (group < m_current || group >= int(m_groups.size()))
        throw Error("group " + std::to_string(group) + " is out of order");
    if (group != m_current)
        finish_look(parallel);
    m_current = group;

    const CodeCounts counts = code_counts(frame, m_side, m_uncounted.data(), parallel);
    const auto side = std::size_t(m_side);
    std::vector<std::int32_t> levels;
    for (std::size_t p = 0; p < counts.size(); ++p) {
        double sum = 0.0, samples = 0.0;
        for (std::size_t code = 0; code < codes; ++code) {
            sum += double(code) * counts[p][code];
            samples += counts[p][code];
        }
        levels.push_back(std::int32_t(std::lround(sum / std::max(samples, 1.0))));
    }

    Look& look = m_looks[std::size_t(group)];
    GroupSums& sums = m_groups[std::size_t(group)];
    const std::size_t samples = m_marked.size();
    if (sums.frames == 0) {
        look.sum.assign(samples, 0);
        look.base.assign(levels.begin(), levels.end());
        m_highest.assign(samples, std::numeric_limits<std::int16_t>::min());
        m_lowest.assign(samples, std::numeric_limits<std::int16_t>::max());
    }
    ++sums.frames;
    look.levels.push_back(levels);
    each_strip(frame.height, parallel, [&](int first, int count) {
        for (int r = first; r < first + count; ++r) {
            const std::uint16_t* const row = frame.row(r);
            const std::size_t at = std::size_t(r) * std::size_t(frame.width);
            for (std::size_t q = 0; q < side; ++q) {
                const std::int32_t level = levels[std::size_t(r) % side * side + q];
                for (std::size_t c = q; c < std::size_t(frame.width); c += side) {
                    look.sum[at + c] += row[c];
                    const std::int16_t above = saturated(row[c] - level);
                    m_highest[at + c] = std::max(m_highest[at + c], above);
                    m_lowest[at + c] = std::min(m_lowest[at + c], above);
                }
            }
        }
    });
    return counts;
}

void FrameStatistics::exclude(const Plane<const std::uint8_t>& samples)
{
    if (samples.width != m_size.width || samples.height != m_size.height)
        throw Error("mask is " + size_text({ samples.width, samples.height })
                    + " pixels, the frames " + size_text(m_size));
    for (int r = 0; r < m_size.height; ++r)
        for (int c = 0; c < m_size.width; ++c)
            if (samples.row(r)[c]) {
                const auto at = std::size_t(r) * std::size_t(m_size.width);
                m_excluded[at + std::size_t(c)] = m_marked[at + std::size_t(c)] = 1;
            }
    if (m_groups.empty() || m_groups.front().frames == 0)
        m_uncounted = m_excluded;
}

void FrameStatistics::measure(int group, const Plane<const std::uint16_t>& frame,
                              const Plane<const std::uint16_t>* other,
                              const ParallelFor& parallel)
{
    if (m_masks.empty() || group < 0 || group >= int(m_groups.size()))
        throw Error("group " + std::to_string(group)
                    + " cannot be measured: look at all frames, then mask");
    check_size(frame);
    if (other)
        check_size(*other);
    const auto sums = filled_sums(group, frame, parallel);
    add_frame(group, frame, sums);
    if (!other)
        return;
    const auto others = filled_sums(group, *other, parallel);
    add_frame(group, *other, others);
    add_pair(group, frame, *other, sums, others, parallel);
}

namespace {

/// What rows and columns of a plane's frame are above those of its group's mean image,
/// by the samples that are not masked.
struct LineShifts {
    std::vector<double> rows, columns;
};

/// @p raw, @p filled: of masked samples, in the frame's sums and in those of the mean
/// image.
LineShifts shifts_of(const PlaneParts& plane, const std::vector<std::uint32_t>& samples,
                     const PlaneSums& frame, const PlaneSums& mean,
                     const std::vector<double>& raw, const std::vector<double>& filled)
{
    const auto width = std::uint32_t(plane.width());
    std::vector<double> left_in_rows(std::size_t(plane.height()), plane.width());
    std::vector<double> left_in_columns(width, plane.height());
    LineShifts shifts { frame.rows, frame.columns };
    double all = frame.sum - mean.sum;
    for (std::size_t y = 0; y < shifts.rows.size(); ++y)
        shifts.rows[y] -= mean.rows[y];
    for (std::size_t x = 0; x < width; ++x)
        shifts.columns[x] -= mean.columns[x];
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const double more = raw[i] - filled[i];
        const std::size_t y = samples[i] / width, x = samples[i] % width;
        all -= more;
        shifts.rows[y] -= more;
        shifts.columns[x] -= more;
        --left_in_rows[y];
        --left_in_columns[x];
    }
    all /= plane.samples() - double(samples.size());
    double rows = 0.0;
    for (std::size_t y = 0; y < shifts.rows.size(); ++y) {
        double& shift = shifts.rows[y];
        shift = left_in_rows[y] > 0.0 ? shift / left_in_rows[y] : all;
        rows += shift;
    }
    for (double& shift : shifts.columns)
        shift -= rows;
    for (const std::uint32_t at : samples)
        shifts.columns[at % width] += shifts.rows[at / width];
    for (std::size_t x = 0; x < width; ++x) {
        double& shift = shifts.columns[x];
        shift = left_in_columns[x] > 0.0 ? shift / left_in_columns[x] : 0.0;
    }
    return shifts;
}

} // namespace

/// A frame whose masked samples are the group's mean, as much above it as the frame's
/// rows and columns are.
std::vector<FrameStatistics::Filled>
FrameStatistics::filled_sums(int group, const Plane<const std::uint16_t>& frame,
                             const ParallelFor& parallel) const
{
    const Look& look = m_looks[std::size_t(group)];
    const GroupSums& of_group = m_groups[std::size_t(group)];
    std::vector<Filled> found;
    for (PlaneSums& sums : sums_of(frame, m_planes, look.base, parallel))
        found.push_back({ std::move(sums), {} });
    parallel(int(m_planes.size()), [&](int p) {
        const auto number = std::size_t(p);
        const PlaneParts& plane = m_planes[number];
        const auto& samples = m_masks[number].samples;
        const auto width = std::uint32_t(plane.width());
        auto& [sums, masked] = found[number];
        std::vector<double> raw;
        raw.reserve(samples.size());
        for (const std::uint32_t at : samples)
            raw.push_back(frame(plane.site(int(at / width), int(at % width)))
                          - look.base[number]);
        masked = look.filled[number];
        const LineShifts shifts = shifts_of(plane, samples, sums,
                                            of_group.planes[number].mean, raw, masked);
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const std::size_t y = samples[i] / width, x = samples[i] % width;
            masked[i] += shifts.rows[y] + shifts.columns[x];
            sums.replace(plane, int(y), int(x), raw[i], masked[i]);
        }
        sums.set_field(plane);
    });
    return found;
}

void FrameStatistics::add_frame(int group, const Plane<const std::uint16_t>& frame,
                                const std::vector<Filled>& planes)
{
    add_transients(group, frame);
    GroupSums& of_group = m_groups[std::size_t(group)];
    for (std::size_t p = 0; p < m_planes.size(); ++p) {
        const PlaneParts& plane = m_planes[p];
        PlaneOfGroup& to = of_group.planes[p];
        const double samples = plane.samples();
        const PlaneSums& sums = planes[p].sums;
        to.levels.push_back(m_looks[std::size_t(group)].base[p] + sums.sum / samples);
        PlaneSums rest = sums;
        rest -= to.mean;
        // Over all frames, what is squared about the mean is squares less the mean's.
        double pixel = sums.squares - to.mean.squares - rest.sum * rest.sum / samples;
        const PartSquares squares = squares_of_parts(plane, rest);
        for (std::size_t part = 0; part + 1 < part_count; ++part) {
            to.scatter[part] += squares[part];
            pixel -= squares[part];
        }
        to.scatter[part_count - 1] += pixel;
    }
}

/// Finds which of its group's transients a frame has.
void FrameStatistics::add_transients(int group, const Plane<const std::uint16_t>& frame)
{
    Look& look = m_looks[std::size_t(group)];
    auto& found = m_groups[std::size_t(group)].transients;
    const auto& levels = look.levels[found.size()];
    auto& counts = found.emplace_back();
    const auto is_own = [&](const Transient& one) {
        const Site site { int(one.at) / m_size.width, int(one.at) % m_size.width };
        const int plane = site.row % m_side * m_side + site.col % m_side;
        if (saturated(frame(site) - levels[std::size_t(plane)]) != one.own)
            return false;
        ++counts[one.is_above ? 0 : 1];
        return true;
    };
    auto& left = look.transients;
    left.erase(std::remove_if(left.begin(), left.end(), is_own), left.end());
}

namespace {

/// Sums of squares of a - b over all samples of each plane.
std::vector<double> squares_of(const Plane<const std::uint16_t>& a,
                               const Plane<const std::uint16_t>& b,
                               const std::vector<PlaneParts>& planes,
                               const ParallelFor& parallel)
{
    const auto side = std::size_t(planes.front().side);
    std::vector<std::vector<double>> rows(std::size_t(a.height),
                                          std::vector<double>(side));
    each_strip(a.height, parallel, [&](int first, int count) {
        for (int r = first; r < first + count; ++r)
            for (std::size_t q = 0; q < side; ++q) {
                std::int64_t sum = 0;
                for (std::size_t c = q; c < std::size_t(a.width); c += side) {
                    const std::int64_t rest
                        = std::int64_t(a.row(r)[c]) - std::int64_t(b.row(r)[c]);
                    sum += rest * rest;
                }
                rows[std::size_t(r)][q] = double(sum);
            }
    });
    std::vector<double> sums(planes.size());
    for (std::size_t r = 0; r < rows.size(); ++r)
        for (std::size_t q = 0; q < side; ++q)
            sums[r % side * side + q] += rows[r][q];
    return sums;
}

} // namespace

void FrameStatistics::add_pair(int group, const Plane<const std::uint16_t>& a,
                               const Plane<const std::uint16_t>& b,
                               const std::vector<Filled>& filled_a,
                               const std::vector<Filled>& filled_b,
                               const ParallelFor& parallel)
{
    GroupSums& of_group = m_groups[std::size_t(group)];
    const auto side = std::size_t(m_side);
    auto squares = squares_of(a, b, m_planes, parallel);
    std::vector<PlaneSums> rest;
    rest.reserve(m_planes.size()); // those that are smooth refer to it
    std::vector<float> inverse;
    std::vector<SmoothRows> smooth;
    std::vector<std::vector<std::uint8_t>> blocks; // of each column
    for (std::size_t p = 0; p < m_planes.size(); ++p) {
        const PlaneParts& plane = m_planes[p];
        rest.push_back(filled_a[p].sums);
        rest[p] -= filled_b[p].sums;
        const auto width = std::uint32_t(plane.width());
        const auto& samples = m_masks[p].samples;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const Site site
                = plane.site(int(samples[i] / width), int(samples[i] % width));
            const double value = double(a(site)) - double(b(site));
            const double fill = filled_a[p].masked[i] - filled_b[p].masked[i];
            squares[p] += fill * fill - value * value;
        }
        double pixel = squares[p] - rest[p].sum * rest[p].sum / plane.samples();
        for (const double square : squares_of_parts(plane, rest[p]))
            pixel -= square;
        const double freedom = m_masks[p].freedom[part_count - 1];
        const double power = freedom > 0.0 ? std::max(pixel / 2.0 / freedom, 0.0) : 0.0;
        of_group.planes[p].power += power;
        inverse.push_back(power > 0.0 ? float(1.0 / std::sqrt(2.0 * power)) : 0.0f);
        smooth.emplace_back(plane, rest[p]);
        blocks.emplace_back();
        for (int x = 0; x < plane.width(); ++x)
            blocks.back().push_back(std::uint8_t(block_of(x, plane.width())));
        auto& noise = of_group.planes[p].masked_noise;
        noise.resize(samples.size());
        SmoothRow line {};
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const int y = int(samples[i] / width), x = int(samples[i] % width);
            if (i == 0 || y != int(samples[i - 1] / width))
                line = smooth.back().at(y);
            const Site site = plane.site(y, x);
            const double value
                = double(a(site)) - double(b(site)) - smooth.back().of(line, x);
            noise[i] += value * value / 2.0;
        }
    }
    const std::size_t words = words_of(m_size.width);
    of_group.noisy.resize(words * std::size_t(m_size.height));

    std::vector<PairStrip> parts;
    parts.resize(std::size_t(strip_count(m_size.height)));
    each_strip(m_size.height, parallel, [&](int first, int count) {
        PairStrip& part = parts[std::size_t(first / strip_rows)];
        part.planes.resize(m_planes.size());
        const auto width = std::size_t(m_size.width);
        std::array<std::vector<float>, 3> rows; // of the mosaic: this and two above
        std::vector<double> parts_of_row;
        std::vector<float> z;
        for (std::vector<float>& row : rows)
            row.assign(width, 0.0f);
        for (int r = std::max(first - 2, 0); r < first + count; ++r) {
            std::rotate(rows.begin(), rows.end() - 1, rows.end());
            const bool is_own = r >= first;
            for (std::size_t q = 0; q < side; ++q) {
                const std::size_t p = std::size_t(r) % side * side + q;
                const PlaneParts& plane = m_planes[p];
                const int y = r / m_side;
                smooth[p].row(y, parts_of_row);
                z.resize(std::size_t(plane.width()));
                const std::uint16_t *const row_a = a.row(r) + q,
                                           *const row_b = b.row(r) + q;
                const std::uint8_t* const marks = &m_marked[std::size_t(r) * width + q];
                const float scale = inverse[p];
                for (std::size_t x = 0; x < z.size(); ++x) {
                    const std::size_t at = x * side;
                    const float value
                        = float((int(row_a[at]) - int(row_b[at])) - parts_of_row[x]);
                    z[x] = marks[at] ? 0.0f : value * scale;
                    rows[0][at + q] = z[x];
                }
                if (!is_own)
                    continue;
                ResidualSums& sums = part.planes[p];
                add_fourth_powers(z.data(), int(z.size()), sums.fourth);
                const std::size_t down
                    = block_of(y, plane.height()) * statistics_blocks;
                for (std::size_t x = 0; x < z.size(); ++x) {
                    if (marks[x * side] || scale == 0.0f)
                        continue;
                    const float size = std::abs(z[x]) * statistics_bins_per_sigma;
                    ++sums.counts[std::min(std::size_t(size),
                                           std::size_t(statistics_bins - 1))];
                    sums.noise[down + blocks[p][x]] += double(z[x]) * z[x];
                    if (std::abs(z[x]) > noisy_sigmas) {
                        const std::size_t at = x * side + q;
                        of_group.noisy[std::size_t(r) * words + at / 64]
                            |= std::uint64_t(1) << at % 64;
                    }
                }
            }
            if (!is_own)
                continue;
            for (std::size_t lag = 0; lag < statistics_lags.size(); ++lag) {
                const auto [dy, dx] = statistics_lags[lag];
                if (r >= dy && int(width) > dx)
                    part.lags[lag]
                        += product(rows[0].data() + dx, rows[std::size_t(dy)].data(),
                                   int(width) - dx);
            }
        }
    });
    ++of_group.pairs;
    std::vector<double> fourths(m_planes.size()), seconds(m_planes.size());
    for (const PairStrip& part : parts) {
        for (std::size_t lag = 0; lag < part.lags.size(); ++lag)
            of_group.lags[lag] += part.lags[lag];
        for (std::size_t p = 0; p < m_planes.size(); ++p) {
            PlaneOfGroup& to = of_group.planes[p];
            for (std::size_t i = 0; i < to.residuals.size(); ++i)
                to.residuals[i] += part.planes[p].counts[i];
            const double variance
                = inverse[p] > 0.0f ? 0.5 / (double(inverse[p]) * inverse[p]) : 0.0;
            for (std::size_t i = 0; i < to.noise.size(); ++i) {
                to.noise[i] += part.planes[p].noise[i] * variance;
                seconds[p] += part.planes[p].noise[i];
            }
            fourths[p] += part.planes[p].fourth;
        }
    }
    for (std::size_t p = 0; p < m_planes.size(); ++p) {
        const double left = m_planes[p].samples() - double(m_masks[p].samples.size());
        of_group.planes[p].fourth += fourths[p] * left / (seconds[p] * seconds[p]);
    }
}

std::array<double, statistics_lags.size()> FrameStatistics::lag_counts() const
{
    std::array<double, statistics_lags.size()> counts {};
    const int width = m_size.width, height = m_size.height;
    const auto counts_at = [&](int r, int c) {
        return m_marked[std::size_t(r) * std::size_t(width) + std::size_t(c)] == 0;
    };
    for (std::size_t lag = 0; lag < statistics_lags.size(); ++lag) {
        const auto [dy, dx] = statistics_lags[lag];
        std::int64_t count = 0;
        for (int r = dy; r < height; ++r)
            for (int c = dx; c < width; ++c)
                count += int(counts_at(r, c) && counts_at(r - dy, c - dx));
        counts[lag] = double(count);
    }
    return counts;
}

std::vector<std::vector<double>>
FrameStatistics::products(const ParallelFor& parallel) const
{
    const std::size_t groups = m_groups.size(), side = std::size_t(m_side);
    using Matrices = std::vector<std::vector<double>>;
    const Matrices none(m_planes.size(), std::vector<double>(groups * groups));
    std::vector<Matrices> parts(std::size_t(strip_count(m_size.height)), none);
    each_strip(m_size.height, parallel, [&](int first, int count) {
        Matrices& part = parts[std::size_t(first / strip_rows)];
        std::vector<std::vector<double>> rows(groups);
        for (int r = first; r < first + count; ++r)
            for (std::size_t q = 0; q < side; ++q) {
                const std::size_t p = std::size_t(r) % side * side + q;
                const auto width = std::size_t(m_planes[p].width());
                for (std::size_t g = 0; g < groups; ++g) {
                    rows[g].resize(width);
                    const std::uint32_t* const from = sum_of(int(g)).row(r) + q;
                    const double frames = m_groups[g].frames, base = m_looks[g].base[p];
                    for (std::size_t x = 0; x < width; ++x)
                        rows[g][x] = from[x * side] / frames - base;
                }
                for (std::size_t g = 0; g < groups; ++g)
                    for (std::size_t h = 0; h <= g; ++h)
                        part[p][g * groups + h]
                            += dot(rows[g].data(), rows[h].data(), int(width));
            }
    });
    Matrices found = none;
    for (const Matrices& part : parts)
        for (std::size_t p = 0; p < found.size(); ++p)
            for (std::size_t i = 0; i < found[p].size(); ++i)
                found[p][i] += part[p][i];
    for (std::size_t p = 0; p < found.size(); ++p)
        for (std::size_t g = 0; g < groups; ++g)
            for (std::size_t h = 0; h <= g; ++h) {
                double& sum = found[p][g * groups + h];
                const PlaneParts& plane = m_planes[p];
                const auto& samples = m_masks[p].samples;
                const auto width = std::uint32_t(plane.width());
                for (std::size_t i = 0; i < samples.size(); ++i) {
                    const Site site
                        = plane.site(int(samples[i] / width), int(samples[i] % width));
                    const auto raw = [&](std::size_t group) {
                        return sum_of(int(group))(site) / double(m_groups[group].frames)
                            - m_looks[group].base[p];
                    };
                    sum += m_looks[g].filled[p][i] * m_looks[h].filled[p][i]
                        - raw(g) * raw(h);
                }
                sum -= m_groups[g].planes[p].mean.sum * m_groups[h].planes[p].mean.sum
                    / plane.samples();
                found[p][h * groups + g] = sum;
            }
    return found;
}

std::vector<std::int64_t> FrameStatistics::overlaps() const
{
    const std::size_t groups = m_groups.size();
    std::vector<std::int64_t> found(groups * groups);
    for (std::size_t g = 0; g < groups; ++g)
        for (std::size_t h = 0; h <= g; ++h) {
            const auto &one = m_groups[g].noisy, &other = m_groups[h].noisy;
            std::int64_t count = 0;
            for (std::size_t i = 0; i < std::min(one.size(), other.size()); ++i)
                count += std::int64_t(std::bitset<64>(one[i] & other[i]).count());
            found[g * groups + h] = found[h * groups + g] = count;
        }
    return found;
}

void FrameStatistics::mean(int group, const Plane<float>& to) const
{
    const double frames = m_groups[std::size_t(group)].frames;
    for (int r = 0; r < m_size.height; ++r)
        for (int c = 0; c < m_size.width; ++c)
            to.row(r)[c] = float(sum_of(group).row(r)[c] / frames);
}

} // namespace cg2raw

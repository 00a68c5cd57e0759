// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Masked samples of a plane, and what stands in their place.
#include "cg2raw/frame_parts.h"

#include "lanes.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cg2raw {
namespace {

constexpr double share_of_line = 0.9; ///< masked, from which a line is masked
constexpr double settled = 1e-6; ///< DN rms, that fills may be from what parts say
constexpr double least_left = 0.1; ///< of a shape's squares, that tells all of it

/// The nearest line that is not lost, the first of two; itself, if it is not.
int nearest_left(const std::vector<std::uint8_t>& lost, int line)
{
    const int count = int(lost.size());
    for (int away = 0; away < count; ++away)
        for (const int other : { line - away, line + away })
            if (other >= 0 && other < count && !lost[std::size_t(other)])
                return other;
    return line;
}

std::vector<int> nearest_of_all(const std::vector<std::uint8_t>& lost)
{
    std::vector<int> found;
    for (std::size_t i = 0; i < lost.size(); ++i)
        found.push_back(nearest_left(lost, int(i)));
    return found;
}

/// An image while its masked samples are filled.
class Filler {
public:
    Filler(const PlaneParts& plane, const PlaneMask& mask,
           const std::function<double(int row, int col)>& sample, PlaneSums& sums)
        : m_plane(plane)
        , m_mask(mask)
        , m_sample(sample)
        , m_sums(sums)
        , m_rows(nearest_of_all(mask.rows))
        , m_columns(nearest_of_all(mask.columns))
    {
        for (const std::uint32_t at : mask.samples) {
            const Site place { int(at / std::uint32_t(plane.width())),
                               int(at % std::uint32_t(plane.width())) };
            const int source = m_columns[std::size_t(place.col)];
            const Run* const last = m_runs.empty() ? nullptr : &m_runs.back();
            if (last && last->row == place.row && last->col + last->count == place.col
                && last->source + last->count == source)
                ++m_runs.back().count;
            else
                m_runs.push_back({ place.row, place.col, source, 1 });
            m_places.push_back(place);
            m_values.push_back(sample(place.row, place.col));
        }
        m_in_sums = m_values;
    }

    std::vector<double> run(int rounds)
    {
        fill_points_by_rows();
        copy_lines();
        update_sums();
        settle(rounds);
        update_sums();
        m_sums.set_field(m_plane);
        return std::move(m_values);
    }

private:
    /// Masked samples side by side, whose fills come from columns side by side.
    struct Run {
        int row, col, source, count;
    };

    bool is_point(const Site& at) const
    {
        return !m_mask.rows[std::size_t(at.row)]
            && !m_mask.columns[std::size_t(at.col)];
    }

    /// Brings the sums to what is filled in by now.
    void update_sums()
    {
        std::vector<double> change(m_values);
        for (std::size_t i = 0; i < change.size(); ++i) {
            change[i] -= m_in_sums[i];
            m_sums.squares += m_values[i] * m_values[i] - m_in_sums[i] * m_in_sums[i];
        }
        add(change, m_sums);
        m_in_sums = m_values;
    }

    /// Adds a change of the masked samples to sums, but for squares and field.
    void add(const std::vector<double>& change, PlaneSums& sums) const
    {
        const double* from = change.data();
        for (const Run& run : m_runs) {
            const auto row = std::size_t(run.row);
            const RowSums found = add_run(from, m_plane.across, run.col, run.count,
                                          sums.columns.data());
            sums.rows[row] += found.sum;
            sums.sum += found.sum;
            for (std::size_t k = 0; k < field_degree; ++k)
                sums.along[row][k] += found.along[k];
            from += run.count;
        }
    }

    /// The mean of the samples of a point's row that are not masked.
    void fill_points_by_rows()
    {
        std::vector<double> sums(m_sums.rows);
        std::vector<int> left(sums.size(), m_plane.width());
        for (std::size_t i = 0; i < m_values.size(); ++i) {
            const auto row = std::size_t(m_places[i].row);
            sums[row] -= m_values[i];
            --left[row];
        }
        for (std::size_t i = 0; i < m_values.size(); ++i) {
            const auto row = std::size_t(m_places[i].row);
            if (is_point(m_places[i]))
                m_values[i] = left[row] > 0 ? sums[row] / left[row] : 0.0;
        }
    }

    /// Moves the fills to where the parts say what they are. They are those of the
    /// image with its fills, so that each depends on all. Shapes of which less than
    /// least_left is outside of the mask are followed in part: whole, they would be
    /// fitted to the noise of what is left.
    ///
    /// Source: G. Golub, R. Varga, Numerische Mathematik 3, 1961 (Chebyshev's
    /// semi-iterative method).
    void settle(int rounds)
    {
        constexpr double middle = (1.0 + least_left) / 2, half = (1.0 - least_left) / 2;
        const int count = int(m_values.size());
        std::vector<double> left = said_of(m_sums);
        for (std::size_t i = 0; i < left.size(); ++i)
            left[i] -= m_values[i];
        std::vector<double> moved(left.size()), step(left);
        for (double& value : step)
            value /= middle;
        double ratio = half / middle;
        for (int round = 0; round < rounds; ++round) {
            if (dot(left.data(), left.data(), count) <= settled * settled * count)
                break;
            const std::vector<double> less = less_of(step);
            const double next = 1.0 / (2.0 * middle / half - ratio);
            for (std::size_t i = 0; i < left.size(); ++i) {
                moved[i] += step[i];
                left[i] -= less[i];
                step[i] = next * (ratio * step[i] + 2.0 / half * left[i]);
            }
            ratio = next;
        }
        for (std::size_t i = 0; i < moved.size(); ++i)
            m_values[i] += moved[i];
    }

    /// A change, less what the parts then say more.
    std::vector<double> less_of(const std::vector<double>& change) const
    {
        PlaneSums sums;
        sums.rows.resize(m_sums.rows.size());
        sums.columns.resize(m_sums.columns.size());
        sums.along.resize(m_sums.along.size());
        add(change, sums);
        std::vector<double> less = said_of(sums);
        for (std::size_t i = 0; i < less.size(); ++i)
            less[i] = change[i] - less[i];
        return less;
    }

    /// What the parts say of masked samples, of a line what they say of the nearest
    /// one that is left: so that pixel has nothing of it.
    std::vector<double> said_of(PlaneSums& sums) const
    {
        sums.set_field(m_plane);
        const SmoothRows smooth(m_plane, sums);
        std::vector<double> said(m_values.size());
        double* to = said.data();
        SmoothRow line {};
        int row = -1;
        for (const Run& run : m_runs) {
            if (run.row != row)
                line = smooth.at(m_rows[std::size_t(row = run.row)]);
            smooth.run(line, run.source, run.count, to);
            to += run.count;
        }
        return said;
    }

    void copy_lines()
    {
        for (std::size_t i = 0; i < m_values.size(); ++i)
            if (!is_point(m_places[i]))
                m_values[i] = value_at(m_rows[std::size_t(m_places[i].row)],
                                       m_columns[std::size_t(m_places[i].col)]);
    }

    /// Filled, or as it is.
    double value_at(int row, int col) const
    {
        const auto at
            = std::uint32_t(row) * std::uint32_t(m_plane.width()) + std::uint32_t(col);
        const auto found
            = std::lower_bound(m_mask.samples.begin(), m_mask.samples.end(), at);
        if (found == m_mask.samples.end() || *found != at)
            return m_sample(row, col);
        return m_values[std::size_t(found - m_mask.samples.begin())];
    }

    const PlaneParts& m_plane;
    const PlaneMask& m_mask;
    const std::function<double(int row, int col)>& m_sample;
    PlaneSums& m_sums;
    std::vector<int> m_rows, m_columns; ///< the nearest of each that is left
    std::vector<Site> m_places; ///< of masked samples in the plane
    std::vector<double> m_values, m_in_sums; ///< as they are, and as the sums have them
    std::vector<Run> m_runs; ///< of places
};

} // namespace

PlaneMask mask_of(const PlaneParts& plane, std::uint8_t* marked, int pitch)
{
    const int height = plane.height(), width = plane.width();
    const auto mark = [&](int y, int x) -> std::uint8_t& {
        return marked[std::ptrdiff_t(plane.first_row + y * plane.side) * pitch
                      + plane.first_col + std::ptrdiff_t(x) * plane.side];
    };
    std::vector<int> in_row(std::size_t(height), 0), in_col(std::size_t(width), 0);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            in_row[std::size_t(y)] += mark(y, x);
            in_col[std::size_t(x)] += mark(y, x);
        }
    PlaneMask mask;
    for (const int count : in_row)
        mask.rows.push_back(count > share_of_line * width);
    for (const int count : in_col)
        mask.columns.push_back(count > share_of_line * height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            mark(y, x) |= mask.rows[std::size_t(y)] | mask.columns[std::size_t(x)];
            if (mark(y, x))
                mask.samples.push_back(std::uint32_t(y) * std::uint32_t(width)
                                       + std::uint32_t(x));
        }
    const double left = 1.0 - double(mask.samples.size()) / plane.samples();
    mask.freedom = plane.freedom();
    const double field = (height - 1.0) * (width - 1.0) - mask.freedom.back();
    for (double& part : mask.freedom)
        part *= left; // what is filled in has no noise, in any part
    // Of pixels, the means of lines that are left take theirs.
    const auto rows = double(std::count(mask.rows.begin(), mask.rows.end(), 0));
    const auto columns
        = double(std::count(mask.columns.begin(), mask.columns.end(), 0));
    const double in_lines = std::max(rows * columns / plane.samples(), 1e-300);
    const double pixels = (rows - 1.0) * (columns - 1.0) - field * in_lines;
    mask.freedom.back() = std::max(pixels, 0.0) * left / in_lines;
    return mask;
}

std::vector<double> fill(const PlaneParts& plane, const PlaneMask& mask,
                         const std::function<double(int row, int col)>& sample,
                         PlaneSums& sums, int rounds)
{
    const auto is_left = [](std::uint8_t masked) { return masked == 0; };
    if (std::none_of(mask.rows.begin(), mask.rows.end(), is_left)
        || std::none_of(mask.columns.begin(), mask.columns.end(), is_left))
        throw Error("nearly all samples are masked: none is left to measure");
    return Filler(plane, mask, sample, sums).run(rounds);
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Masked samples of a plane, and what stands in their place.
#include "cg2raw/frame_parts.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cg2raw {
namespace {

constexpr double share_of_line = 0.9; ///< masked, from which a line is masked
constexpr double settled = 1e-10; ///< DN, that a round of fills moves at most

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
            m_places.push_back({ int(at / std::uint32_t(plane.width())),
                                 int(at % std::uint32_t(plane.width())) });
            m_values.push_back(sample(m_places.back().row, m_places.back().col));
        }
        m_across.resize(std::size_t(plane.width()));
        for (std::size_t x = 0; x < m_across.size(); ++x)
            for (int k = 0; k < plane.across.in_field(); ++k)
                m_across[x][std::size_t(k)] = plane.across.of(k + 1)[x];
    }

    std::vector<double> run(int rounds)
    {
        fill_points_by_rows();
        copy_lines();
        for (int round = 0; round < rounds && fill_by_parts() > settled; ++round) { }
        m_sums.set_field(m_plane);
        return std::move(m_values);
    }

private:
    struct RowChange {
        double sum;
        std::array<double, field_degree> along;
    };

    bool is_point(const Site& at) const
    {
        return !m_mask.rows[std::size_t(at.row)]
            && !m_mask.columns[std::size_t(at.col)];
    }

    void put(std::size_t i, double value)
    {
        m_sums.replace(m_plane, m_places[i].row, m_places[i].col, m_values[i], value);
        m_values[i] = value;
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
                put(i, left[row] > 0 ? sums[row] / left[row] : 0.0);
        }
    }

    /// What the parts say, of a line what they say of the nearest one that is left: so
    /// that pixel has nothing of it. Returns by how much a sample moves at most.
    double fill_by_parts()
    {
        m_sums.set_field(m_plane);
        const SmoothRows smooth(m_plane, m_sums);
        double most = 0.0;
        for (std::size_t i = 0; i < m_values.size();) {
            const int row = m_places[i].row;
            const SmoothRow line = smooth.at(m_rows[std::size_t(row)]);
            RowChange change {};
            for (; i < m_values.size() && m_places[i].row == row; ++i) {
                const auto col = std::size_t(m_places[i].col);
                const auto from = std::size_t(m_columns[col]);
                double value = line.mean + m_sums.columns[from] / m_plane.height()
                    - m_sums.sum / m_plane.samples();
                for (std::size_t k = 0; k < field_degree; ++k)
                    value += line.along[k] * m_across[from][k];
                const double more = value - m_values[i];
                most = std::max(most, std::abs(more));
                m_sums.columns[col] += more;
                m_sums.sum += more;
                m_sums.squares += value * value - m_values[i] * m_values[i];
                change.sum += more;
                for (std::size_t k = 0; k < field_degree; ++k)
                    change.along[k] += more * m_across[col][k];
                m_values[i] = value;
            }
            m_sums.rows[std::size_t(row)] += change.sum;
            for (std::size_t k = 0; k < field_degree; ++k)
                m_sums.along[std::size_t(row)][k] += change.along[k];
        }
        return most;
    }

    void copy_lines()
    {
        for (std::size_t i = 0; i < m_values.size(); ++i)
            if (!is_point(m_places[i]))
                put(i,
                    value_at(m_rows[std::size_t(m_places[i].row)],
                             m_columns[std::size_t(m_places[i].col)]));
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
    std::vector<double> m_values;
    std::vector<std::array<double, field_degree>> m_across; ///< of each column
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

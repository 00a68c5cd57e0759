// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/frame_parts.h"

#include "lanes.h"
#include "multiversion.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace cg2raw {
namespace {

/// A row of a plane, gathered from its mosaic.
template <class T>
void gather(const T* mosaic, int side, int width, double base, double* to)
{
    for (int i = 0; i < width; ++i)
        to[i] = double(mosaic[std::ptrdiff_t(i) * side]) - base;
}

/// Of the rows of a plane in a strip of the mosaic.
struct StripSums {
    std::vector<double> columns;
    double sum = 0.0, squares = 0.0;
};

/// Squares of a profile's smooth, slow and fast coefficients. @p scale: samples in each
/// of its sums.
std::array<double, 3> squares_of_profile(const std::vector<double>& sums, double scale,
                                         const Polynomials& low)
{
    double mean = 0.0;
    for (const double sum : sums)
        mean += sum;
    mean /= double(sums.size());
    std::vector<double> rest(sums);
    double all = 0.0;
    for (double& value : rest) {
        value -= mean;
        all += value * value;
    }
    std::array<double, 3> squares {};
    for (int k = 1; k <= low.degree(); ++k) {
        const double found = dot(rest.data(), low.of(k), low.length());
        squares[k > smooth_degree ? 1 : 0] += found * found;
    }
    squares[2] = std::max(all - squares[0] - squares[1], 0.0);
    for (double& square : squares)
        square /= scale;
    return squares;
}

/// What all parts but pixel have in samples side by side.
CG2RAW_MULTIVERSION
void parts_of_run(const SmoothRow& line, const double* columns,
                  const Polynomials& across, int first, int count, double* to)
{
    for (int i = 0; i < count; ++i)
        to[i] = columns[first + i] + line.mean;
    for (int k = 0; k < across.in_field(); ++k) {
        const double* const of_degree = across.of(k + 1) + first;
        for (int i = 0; i < count; ++i)
            to[i] += line.along[std::size_t(k)] * of_degree[i];
    }
}

} // namespace

Polynomials::Polynomials(int length)
    : m_length(length)
    , m_degree(std::min(slow_degree, (length - 1) / 2))
    , m_values(std::size_t(m_degree) * std::size_t(length))
{
    // Stieltjes' recurrence; on places that mirror each other it has no constant.
    std::vector<double> before(std::size_t(length), 0.0);
    std::vector<double> now(std::size_t(length), 1.0 / std::sqrt(double(length)));
    double ratio = 0.0;
    for (int k = 1; k <= m_degree; ++k) {
        double* const next = &m_values[std::size_t(k - 1) * std::size_t(length)];
        for (int i = 0; i < length; ++i) {
            const auto at = std::size_t(i);
            const double place = 2.0 * i / (length - 1) - 1.0;
            next[i] = place * now[at] - ratio * before[at];
        }
        ratio = std::sqrt(dot(next, next, length));
        for (int i = 0; i < length; ++i)
            next[i] /= ratio;
        before.swap(now);
        now.assign(next, next + length);
    }
}

PartSquares PlaneParts::freedom() const
{
    const auto of_line = [](const Polynomials& line) {
        const int smooth = std::min(smooth_degree, line.degree());
        return std::array { double(smooth), double(line.degree() - smooth),
                            double(line.length() - 1 - line.degree()) };
    };
    const auto rows = of_line(down), columns = of_line(across);
    const double field = double(down.in_field()) * across.in_field();
    const double pixel = (height() - 1.0) * (width() - 1.0) - field;
    return {
        rows[0], columns[0], rows[1], columns[1], rows[2], columns[2], field, pixel
    };
}

CG2RAW_MULTIVERSION
RowSums add_run(const double* samples, const Polynomials& across, int first, int count,
                double* columns)
{
    for (int i = 0; i < count; ++i)
        columns[first + i] += samples[i];
    RowSums sums {};
    sums.sum = total(samples, count);
    sums.squares = dot(samples, samples, count);
    for (int k = 0; k < across.in_field(); ++k)
        sums.along[std::size_t(k)] = dot(samples, across.of(k + 1) + first, count);
    return sums;
}

void PlaneSums::replace(const PlaneParts& plane, int row, int col, double from,
                        double to)
{
    const double more = to - from;
    rows[std::size_t(row)] += more;
    columns[std::size_t(col)] += more;
    sum += more;
    squares += to * to - from * from;
    for (int k = 0; k < plane.across.in_field(); ++k)
        along[std::size_t(row)][std::size_t(k)] += more * plane.across.of(k + 1)[col];
}

void PlaneSums::set_field(const PlaneParts& plane)
{
    field = {};
    for (int j = 0; j < plane.down.in_field(); ++j)
        for (int y = 0; y < plane.height(); ++y)
            for (int k = 0; k < plane.across.in_field(); ++k)
                field[std::size_t(j * field_degree + k)]
                    += plane.down.of(j + 1)[y] * along[std::size_t(y)][std::size_t(k)];
}

void PlaneSums::scale(double factor)
{
    for (double& value : rows)
        value *= factor;
    for (double& value : columns)
        value *= factor;
    for (auto& row : along)
        for (double& value : row)
            value *= factor;
    for (double& value : field)
        value *= factor;
    sum *= factor;
    squares *= factor * factor;
}

PlaneSums& PlaneSums::operator-=(const PlaneSums& other)
{
    std::transform(rows.begin(), rows.end(), other.rows.begin(), rows.begin(),
                   std::minus<>());
    std::transform(columns.begin(), columns.end(), other.columns.begin(),
                   columns.begin(), std::minus<>());
    for (std::size_t y = 0; y < along.size(); ++y)
        for (std::size_t k = 0; k < field_degree; ++k)
            along[y][k] -= other.along[y][k];
    std::transform(field.begin(), field.end(), other.field.begin(), field.begin(),
                   std::minus<>());
    sum -= other.sum;
    return *this;
}

SmoothRows::SmoothRows(const PlaneParts& plane, const PlaneSums& sums)
    : m_plane(plane)
    , m_sums(sums)
{
    for (const double column : sums.columns)
        m_columns.push_back(column / plane.height() - sums.sum / plane.samples());
}

SmoothRow SmoothRows::at(int y) const
{
    SmoothRow found { m_sums.rows[std::size_t(y)] / m_plane.width(), {} };
    for (int j = 0; j < m_plane.down.in_field(); ++j)
        for (int k = 0; k < field_degree; ++k)
            found.along[std::size_t(k)] += m_plane.down.of(j + 1)[y]
                * m_sums.field[std::size_t(j * field_degree + k)];
    return found;
}

double SmoothRows::of(const SmoothRow& line, int x) const
{
    double found = 0.0;
    run(line, x, 1, &found);
    return found;
}

void SmoothRows::run(const SmoothRow& line, int first, int count, double* to) const
{
    parts_of_run(line, m_columns.data(), m_plane.across, first, count, to);
}

void SmoothRows::row(int y, std::vector<double>& to) const
{
    to.resize(m_columns.size());
    run(at(y), 0, int(to.size()), to.data());
}

PartSquares squares_of_parts(const PlaneParts& plane, const PlaneSums& sums)
{
    const auto rows = squares_of_profile(sums.rows, plane.width(), plane.down);
    const auto columns = squares_of_profile(sums.columns, plane.height(), plane.across);
    double field = 0.0;
    for (const double value : sums.field)
        field += value * value;
    return {
        rows[0], columns[0], rows[1], columns[1], rows[2], columns[2], field, 0.0
    };
}

template <class T>
std::vector<PlaneSums>
sums_of(const Plane<const T>& image, const std::vector<PlaneParts>& planes,
        const std::vector<double>& base, const ParallelFor& parallel)
{
    std::vector<PlaneSums> sums(planes.size());
    for (std::size_t p = 0; p < planes.size(); ++p) {
        sums[p].rows.resize(std::size_t(planes[p].height()));
        sums[p].along.resize(std::size_t(planes[p].height()));
    }
    std::vector<std::vector<StripSums>> strips(std::size_t(strip_count(image.height)));
    const auto side = std::size_t(planes.front().side);
    each_strip(image.height, parallel, [&](int first, int count) {
        auto& strip = strips[std::size_t(first / strip_rows)];
        strip.resize(planes.size());
        std::vector<double> row(std::size_t(planes.front().width()));
        for (int r = first; r < first + count; ++r)
            for (std::size_t q = 0; q < side; ++q) {
                const std::size_t p = std::size_t(r) % side * side + q;
                const PlaneParts& plane = planes[p];
                StripSums& to = strip[p];
                to.columns.resize(std::size_t(plane.width()));
                gather(image.row(r) + q, plane.side, plane.width(), base[p],
                       row.data());
                const RowSums found = add_run(row.data(), plane.across, 0,
                                              plane.width(), to.columns.data());
                const auto y = std::size_t(r / plane.side);
                sums[p].rows[y] = found.sum;
                sums[p].along[y] = found.along;
                to.sum += found.sum;
                to.squares += found.squares;
            }
    });
    for (std::size_t p = 0; p < planes.size(); ++p) {
        sums[p].columns.resize(std::size_t(planes[p].width()));
        for (const auto& strip : strips) {
            const StripSums& from = strip[p];
            for (std::size_t i = 0; i < from.columns.size(); ++i)
                sums[p].columns[i] += from.columns[i];
            sums[p].sum += from.sum;
            sums[p].squares += from.squares;
        }
        sums[p].set_field(planes[p]);
    }
    return sums;
}

template std::vector<PlaneSums> sums_of(const Plane<const std::uint16_t>&,
                                        const std::vector<PlaneParts>&,
                                        const std::vector<double>&, const ParallelFor&);
template std::vector<PlaneSums> sums_of(const Plane<const std::uint32_t>&,
                                        const std::vector<PlaneParts>&,
                                        const std::vector<double>&, const ParallelFor&);

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The orthogonal parts of a plane of samples, and sums by which an image splits
/// into them.
#pragma once

#include "cg2raw/parallel.h"
#include "cg2raw/types.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace cg2raw {

/// Highest degrees of polynomials: smooth and slow rows and columns, field.
inline constexpr int smooth_degree = 3, slow_degree = 11, field_degree = 5;
inline constexpr int field_size = field_degree * field_degree;

/// Rows before columns of each; then field and pixel.
enum class Part {
    smooth_rows,
    smooth_columns,
    slow_rows,
    slow_columns,
    fast_rows,
    fast_columns,
    field,
    pixel
};
inline constexpr int part_count = 8;
using PartSquares = std::array<double, part_count>; ///< by Part

/// Orthonormal polynomials on the places of a line, without the constant.
class Polynomials {
public:
    /// Of degrees 1 to 11; a short line keeps half of its freedom.
    explicit Polynomials(int length);

    int length() const { return m_length; }
    int degree() const { return m_degree; }
    /// Of a degree from 1, at each place.
    const double* of(int degree) const
    {
        return &m_values[std::size_t(degree - 1) * std::size_t(m_length)];
    }
    /// The field's share of them.
    int in_field() const { return m_degree < field_degree ? m_degree : field_degree; }

private:
    int m_length, m_degree;
    std::vector<double> m_values;
};

/// One plane of a CFA's repeat in its mosaic.
struct PlaneParts {
    int first_row, first_col, side;
    Polynomials down, across;

    int height() const { return down.length(); }
    int width() const { return across.length(); }
    double samples() const { return double(height()) * width(); }
    /// Where a sample is in the mosaic.
    Site site(int row, int col) const
    {
        return { first_row + row * side, first_col + col * side };
    }
    /// Degrees of freedom of each part.
    PartSquares freedom() const;
};

/// Sums over samples of a row, with the field's polynomials across, too.
struct RowSums {
    double sum, squares;
    std::array<double, field_degree> along;
};

/// Of @p count samples side by side from column @p first on; adds each to its column.
RowSums add_run(const double* samples, const Polynomials& across, int first, int count,
                double* columns);

/// Sums over an image of one plane, of samples less a base.
struct PlaneSums {
    std::vector<double> rows, columns;
    /// Of each row with the field's polynomials across.
    std::vector<std::array<double, field_degree>> along;
    std::array<double, field_size> field {}; ///< by degree down, then across
    double sum = 0.0, squares = 0.0;

    /// In place of a sample there is another; all but the field know it.
    void replace(const PlaneParts& plane, int row, int col, double from, double to);
    void set_field(const PlaneParts& plane); ///< of the rows
    void scale(double factor);
    PlaneSums& operator-=(const PlaneSums& other); ///< all but squares
};

/// Of a row: its mean, and what the field's polynomials across have in it.
struct SmoothRow {
    double mean;
    std::array<double, field_degree> along;
};

/// What all parts but pixel say of an image, less base, row by row. Columns are those
/// of the sums when it is made.
class SmoothRows {
public:
    SmoothRows(const PlaneParts& plane, const PlaneSums& sums);
    SmoothRow at(int y) const;
    double of(const SmoothRow& line, int x) const;
    /// Of @p count samples of a row, from column @p first on.
    void run(const SmoothRow& line, int first, int count, double* to) const;
    void row(int y, std::vector<double>& to) const;

private:
    const PlaneParts& m_plane;
    const PlaneSums& m_sums;
    std::vector<double> m_columns;
};

/// Squares of an image's coefficients in each part but pixel, which is 0.
PartSquares squares_of_parts(const PlaneParts& plane, const PlaneSums& sums);

/// Sums of each plane of an image, samples less the plane's base.
template <class T>
std::vector<PlaneSums>
sums_of(const Plane<const T>& image, const std::vector<PlaneParts>& planes,
        const std::vector<double>& base, const ParallelFor& parallel);

/// Samples of a plane that do not count.
struct PlaneMask {
    std::vector<std::uint32_t> samples; ///< in raster order of the plane
    std::vector<std::uint8_t> rows, columns; ///< of which none does
    PartSquares freedom {}; ///< that is left
};

/// A plane's mask by the mosaic's marks, 0 or 1. A line of which more than nine tenths
/// are marked is marked as a whole.
PlaneMask mask_of(const PlaneParts& plane, std::uint8_t* marked, int pitch);

/// Fills masked samples of an image whose sums have them as they are: points by all
/// parts but pixel, lines by the nearest that is none. @p sample: (row, col) -> sample
/// less base. @p rounds: of the solver at most, so few that shapes of which hardly
/// anything is left are not fitted to its noise. Returns what is filled in. Throws
/// Error where nothing is left.
std::vector<double> fill(const PlaneParts& plane, const PlaneMask& mask,
                         const std::function<double(int row, int col)>& sample,
                         PlaneSums& sums, int rounds = 20);

} // namespace cg2raw

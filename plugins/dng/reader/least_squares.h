// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Linear least squares of a few unknowns, by their normal equations.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

namespace cg2raw {

template <std::size_t unknowns> class LeastSquares {
public:
    using Row = std::array<double, unknowns>;

    /// An equation: the sum of @p terms, each times its unknown, is @p value.
    void add(const Row& terms, double value)
    {
        for (std::size_t i = 0; i < unknowns; ++i) {
            m_right[i] += terms[i] * value;
            for (std::size_t j = 0; j < unknowns; ++j)
                m_normal[i][j] += terms[i] * terms[j];
        }
    }

    /// The unknowns by Cholesky; nothing if the equations do not determine all.
    std::optional<Row> solved() const
    {
        constexpr double singular = 1e-10;
        std::array<Row, unknowns> normal = m_normal;
        Row right = m_right;
        for (std::size_t j = 0; j < unknowns; ++j) {
            const double whole = normal[j][j];
            for (std::size_t k = 0; k < j; ++k)
                normal[j][j] -= normal[j][k] * normal[j][k];
            if (!(normal[j][j] > singular * whole))
                return std::nullopt;
            normal[j][j] = std::sqrt(normal[j][j]);
            for (std::size_t i = j + 1; i < unknowns; ++i) {
                for (std::size_t k = 0; k < j; ++k)
                    normal[i][j] -= normal[i][k] * normal[j][k];
                normal[i][j] /= normal[j][j];
            }
            for (std::size_t k = 0; k < j; ++k)
                right[j] -= normal[j][k] * right[k];
            right[j] /= normal[j][j];
        }
        for (std::size_t j = unknowns; j-- > 0;) {
            for (std::size_t i = j + 1; i < unknowns; ++i)
                right[j] -= normal[i][j] * right[i];
            right[j] /= normal[j][j];
        }
        return right;
    }

private:
    std::array<Row, unknowns> m_normal {};
    Row m_right {};
};

} // namespace cg2raw

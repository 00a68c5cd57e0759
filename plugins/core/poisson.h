// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Poisson counts, a pure function of key and site.
#pragma once

#include "cg2raw/random.h"

namespace cg2raw {

/// Means from here on: the spread is below the resolution of a float32 signal, and the
/// count is the mean.
constexpr double most_counted = 1e15;
/// Most sites of one call of poisson_counts.
constexpr int poisson_piece = 256;

/// Poisson counts of the sites (row, col) ... (row, col + count - 1); a mean of 0 or
/// less has the count 0. count must be at most poisson_piece.
///
/// Below a mean of 16 the distribution function is inverted by summation: exact to
/// float64's rounding, from a uniform of 52 bits. From 16 on, the count is the floor of
/// Cornish and Fisher's expansion of the quantile at the site's normal, in eight terms:
/// the total variation distance from Poisson is 1.1e-6 at a mean of 16 and falls faster
/// than mean^-2 (4.6e-7 at 20, 1.7e-8 at 50, 1.4e-9 at 100); the normals of Rng reach
/// 6.7 sigma. Source: M. B. Giles, ACM Trans. Math. Software 42(1), 2016, for the
/// method and its first five terms; the other three invert the expansion of the
/// chi-squared quantile by H. Goldberg and H. Levine, Ann. Math. Statist. 17(2), 1946.
void poisson_counts(const Rng& rng, Site at, const double* mean, int count,
                    double* counts);

} // namespace cg2raw

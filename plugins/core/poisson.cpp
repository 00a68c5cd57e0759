// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "poisson.h"

#include "elementary.h"
#include "multiversion.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace cg2raw {
namespace {

/// Means from here on have counts from the expansion.
constexpr double least_expanded = 16.0;
/// More than this has, at a mean of 16, a probability below 1e-35.
constexpr int most_summed = 96;

/// 1 / n: a multiplication is faster than a division.
constexpr std::array<double, most_summed + 1> reciprocals()
{
    std::array<double, most_summed + 1> result {};
    for (int n = 1; n <= most_summed; ++n)
        result[std::size_t(n)] = 1.0 / n;
    return result;
}
constexpr auto reciprocal = reciprocals();

bool is_summed(double mean) { return mean > 0.0 && mean < least_expanded; }

/// counts[i] = least k with P(count <= k) >= uniform[i], where the mean is_summed; all
/// sites together take one step of k after the other, so that the compiler vectorises.
CG2RAW_MULTIVERSION void summed_quantiles(const double* mean, const double* uniform,
                                          int count, double* counts)
{
    double m[poisson_piece], probability[poisson_piece], sum[poisson_piece],
        least[poisson_piece];
    for (int i = 0; i < count; ++i)
        m[i] = is_summed(mean[i]) ? mean[i] : 0.0;
    for (int i = 0; i < count; ++i) {
        sum[i] = probability[i] = exponential(-m[i]);
        least[i] = 0.0;
    }
    std::int64_t waiting = 1;
    for (int k = 1; k <= most_summed && waiting; ++k) {
        const double of_k = reciprocal[std::size_t(k)];
        waiting = 0;
        for (int i = 0; i < count; ++i) {
            const bool beyond = sum[i] < uniform[i];
            least[i] += beyond ? 1.0 : 0.0;
            waiting += beyond ? 1 : 0;
            probability[i] *= m[i] * of_k;
            sum[i] += probability[i];
        }
    }
    for (int i = 0; i < count; ++i)
        counts[i] = is_summed(mean[i]) ? least[i] : counts[i];
}

/// Terms of the expansion in powers of 1 / sqrt(mean), as polynomials of the normal w.
/// Means below least_expanded give numbers that mean nothing.
CG2RAW_MULTIVERSION void expanded_quantiles(const double* mean, const float* normal,
                                            int count, double* quantiles)
{
    for (int i = 0; i < count; ++i) {
        const double m = std::max(mean[i], least_expanded), root = std::sqrt(m);
        const double c = 1.0 / root, w = double(normal[i]), s = w * w;
        double p = w
            * (274867.0 / 146966400.0
               + s
                   * (2647909.0 / 293932800.0
                      + s * (-165779.0 / 195955200.0 + s * (-11237.0 / 43545600.0))));
        p = p * c
            + (-16.0 / 25515.0
               + s * (-5189.0 / 408240.0 + s * (5.0 / 3024.0 + s * (19.0 / 34020.0))));
        p = p * c
            + w * (671.0 / 38880.0 + s * (-137.0 / 38880.0 + s * (-23.0 / 17280.0)));
        p = p * c + (-8.0 / 405.0 + s * (7.0 / 810.0 + s * (1.0 / 270.0)));
        p = p * c + w * (-1.0 / 36.0 + s * (-1.0 / 72.0));
        p = p * c + (1.0 / 3.0 + s * (1.0 / 6.0));
        quantiles[i] = std::max(0.0, std::floor(m + root * w + p));
    }
}

} // namespace

void poisson_counts(const Rng& rng, Site at, const double* mean, int count,
                    double* counts)
{
    assert(count <= poisson_piece);
    std::fill_n(counts, count, 0.0);
    if (std::any_of(mean, mean + count, [](double m) { return m >= least_expanded; })) {
        float normal[poisson_piece];
        rng.normals(at, count, normal);
        expanded_quantiles(mean, normal, count, counts);
    }
    if (std::any_of(mean, mean + count, is_summed)) {
        double uniform[poisson_piece];
        rng.uniforms(at, count, uniform);
        summed_quantiles(mean, uniform, count, counts);
    }
    for (int i = 0; i < count; ++i) {
        if (!(mean[i] > 0.0))
            counts[i] = 0.0; // the expansion gave it a number
        if (mean[i] >= most_counted)
            counts[i] = mean[i];
    }
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Normal scores: residuals whose law is a sum of normals, as standard normal
/// numbers with the same chance of less. And the log of the determinant of that step.
#include "normal_mixture.h"

#include "elementary.h"
#include "multiversion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace cg2raw::python {
namespace {

constexpr double least_of_sum = 1e-300;

/// Of a number in -1 ... 1; powers from the highest. Without a loop, which would keep
/// loops around it from being vectorised.
template <std::size_t count, std::size_t... n>
inline double polynomial(const std::array<double, count>& powers, double x,
                         std::index_sequence<n...> /*each*/)
{
    double sum = 0.0;
    ((sum = sum * x + powers[n]), ...);
    return sum;
}

template <std::size_t count>
inline double polynomial(const std::array<double, count>& powers, double x)
{
    return polynomial(powers, x, std::make_index_sequence<count>());
}

/// The chance of more than x >= 0 of a normal number, over exp(-x^2 / 2): Mills' ratio
/// over the root of 2 pi. Relative error below 1e-14 up to 40. By a polynomial in
/// (x - 4) / (x + 4), after M. M. Shepherd and J. G. Laframboise, Math. Comp. 36, 1981.
inline double scaled_tail(double x)
{
    constexpr std::array<double, 21> powers {
        0x1.34729ae65226cp-27,  0x1.f23eb53fcdf51p-34,  -0x1.837bd76c83635p-24,
        -0x1.22799f19a43adp-25, 0x1.195e5374c71c4p-21,  0x1.db56742492181p-22,
        -0x1.5b982ac2ecd78p-19, -0x1.d03be7d94b18dp-19, 0x1.c8d4b5e794ad9p-17,
        0x1.64b80019485e5p-16,  -0x1.707730249116dp-14, -0x1.8c1573a33d38ep-14,
        0x1.6c5364df475b7p-11,  -0x1.2b7f33b22ad98p-12, -0x1.47d5fbfffeaecp-8,
        0x1.25dd71f577244p-6,   -0x1.07c3c2590d487p-5,  0x1.d4969f119f861p-6,
        0x1.cabd72a623a26p-7,   -0x1.8c18f2086eda6p-4,  0x1.e361ea6fba13cp-2
    };
    return polynomial(powers, (x - 4.0) / (x + 4.0)) / (1.0 + x);
}

/// The x >= 0 that a normal number exceeds with a chance of 1e-300 ... 0.5; absolute
/// error below 1e-11. By a polynomial of its ratio to s, where the chance is
/// exp(-s^2 / 2), in (s - 3) / (s + 3).
inline double exceeded_with(double chance)
{
    constexpr std::array<double, 27> powers {
        -0x1.80f7c035f9f9fp-19, 0x1.8815390687639p-21,  0x1.aa95c7ce17f6ap-17,
        0x1.d78e0d6435ba3p-22,  -0x1.0fead71390962p-15, 0x1.0c7aae923b392p-19,
        0x1.351c60bd0fae4p-15,  0x1.ddb501436740ep-17,  -0x1.f5d6089eb20d9p-15,
        0x1.18f5a6254ced8p-15,  -0x1.7fa7a96014c2ap-15, 0x1.1553390c4b272p-13,
        -0x1.07bb715a45caep-12, 0x1.ce7f83002450cp-12,  -0x1.ac10b17503a9bp-11,
        0x1.89feaf7377455p-10,  -0x1.6ae947c6741ebp-9,  0x1.4aeece61b9683p-8,
        -0x1.2e77232d747a4p-7,  0x1.113e52d0377c6p-6,   -0x1.ece8bfbf59e00p-6,
        0x1.b4ac872e01f80p-5,   -0x1.7eba21de53c83p-4,  0x1.3f3584cac559fp-3,
        -0x1.f4b3d32f09c36p-3,  0x1.0fb6728ff4023p-2,   0x1.c2523ad1dac34p-1
    };
    const double s = std::sqrt(-2.0 * natural_log(chance));
    const double x
        = 0x1.8db25a777486dp+0 * ((s - 3.0) / (s + 3.0)) + -0x1.49f1f0053651ap-2;
    return s * polynomial(powers, x);
}

struct Sums {
    double below[piece]; ///< chance of less than a residual
    double above[piece]; ///< and of more
    double density[piece];
};

/// A normal of a sum, at a piece of residuals.
struct Part {
    double weight[piece];
    double away[piece]; ///< from its mean, in standard deviations
    double inverse[piece]; ///< of a standard deviation, in the residual's unit
};

CG2RAW_MULTIVERSION
void add_part(const Part& part, int count, Sums& sums)
{
    for (int i = 0; i < count; ++i) {
        const double away = part.away[i], far = std::min(std::fabs(away), 37.0);
        const double bell = exponential(std::max(-0.5 * away * away, least_exponent));
        const double tail = bell * scaled_tail(far), rest = 1.0 - tail;
        sums.below[i] += part.weight[i] * (away < 0.0 ? tail : rest);
        sums.above[i] += part.weight[i] * (away < 0.0 ? rest : tail);
        sums.density[i] += part.weight[i] * bell * part.inverse[i];
    }
}

CG2RAW_MULTIVERSION
void write_scores(const Sums& sums, int count, double* to)
{
    for (int i = 0; i < count; ++i) {
        const double least = std::min(sums.below[i], sums.above[i]);
        const double score = exceeded_with(std::max(least, least_of_sum));
        to[i] = sums.below[i] < sums.above[i] ? -score : score;
    }
}

/// Residuals that are narrow or, with a chance, wide: both about 0.
struct TwoNormals {
    const double *z, *chance, *narrow, *wide;
};

CG2RAW_MULTIVERSION
void fill_part(const TwoNormals& law, bool is_wide, py::ssize_t first, int count,
               Part& part)
{
    for (int i = 0; i < count; ++i) {
        const py::ssize_t at = first + i;
        const double variance = is_wide ? law.wide[at] : law.narrow[at];
        part.weight[i] = is_wide ? law.chance[at] : 1.0 - law.chance[at];
        part.inverse[i] = 1.0 / std::sqrt(variance);
        part.away[i] = law.z[at] * part.inverse[i];
    }
}

/// The log of the sum of two densities over that of a standard normal number at a
/// score; however far out, so that no outlier is cheaper than another.
CG2RAW_MULTIVERSION
void write_determinants(const Part& a, const Part& b, const double* score, int count,
                        double* to)
{
    for (int i = 0; i < count; ++i) {
        const double log_a
            = natural_log(a.weight[i] * a.inverse[i]) - 0.5 * a.away[i] * a.away[i];
        const double log_b
            = natural_log(b.weight[i] * b.inverse[i]) - 0.5 * b.away[i] * b.away[i];
        const double apart = std::max(-std::fabs(log_a - log_b), least_exponent);
        to[i] = std::max(log_a, log_b) + natural_log(1.0 + exponential(apart))
            + 0.5 * score[i] * score[i];
    }
}

/// (n,) scores and (n,) logs of determinants.
using Scored = std::pair<Numbers, Numbers>;

Scored of_two_normals(const Numbers& z, const Numbers& chance, const Numbers& narrow,
                      const Numbers& wide)
{
    const auto size = z.size();
    if (chance.size() != size || narrow.size() != size || wide.size() != size)
        throw Error("residuals, chances and variances must be as many");
    Scored result { Numbers(size), Numbers(size) };
    double* const score = result.first.mutable_data();
    double* const log = result.second.mutable_data();
    const TwoNormals law { z.data(), chance.data(), narrow.data(), wide.data() };
    each_piece(size, [&](py::ssize_t first, int count) {
        Part parts[2];
        Sums sums {};
        for (int is_wide = 0; is_wide < 2; ++is_wide) {
            fill_part(law, is_wide != 0, first, count, parts[is_wide]);
            add_part(parts[is_wide], count, sums);
        }
        write_scores(sums, count, score + first);
        write_determinants(parts[0], parts[1], score + first, count, log + first);
    });
    return result;
}

/// Standardised residuals of a frame, the variance of noise without what rates add, and
/// the gain of charge.
struct Residuals {
    const double *z, *variance, *gain;
    double seconds; ///< of exposure
};

CG2RAW_MULTIVERSION
void fill_part(const Mixture& rates, int n, const Residuals& of, py::ssize_t first,
               int count, Part& part)
{
    const double mean = of.seconds * rates.means[n], charge = std::max(mean, 0.0);
    const double spread = of.seconds * of.seconds * rates.variances[n];
    const double weight = rates.weights[n];
    for (int i = 0; i < count; ++i) {
        const double variance = of.variance[first + i];
        const double more = of.gain[first + i] * charge + spread;
        part.weight[i] = weight;
        part.inverse[i] = 1.0 / std::sqrt(1.0 + more / variance);
        const double shift = mean / std::sqrt(variance);
        part.away[i] = (of.z[first + i] - shift) * part.inverse[i];
    }
}

Scored of_rates(const Numbers& law, const Numbers& z, const Numbers& variance,
                const Numbers& gain, double seconds)
{
    const auto size = z.size();
    const Mixture rates = mixture_of(law);
    if (variance.size() != size || gain.size() != size)
        throw Error("residuals, variances and gains must be as many");
    Scored result { Numbers(size), Numbers(size) };
    double* const score = result.first.mutable_data();
    double* const log = result.second.mutable_data();
    const Residuals of { z.data(), variance.data(), gain.data(), seconds };
    each_piece(size, [&](py::ssize_t first, int count) {
        Part part;
        Sums sums {};
        for (int n = 0; n < rates.parts; ++n) {
            fill_part(rates, n, of, first, count, part);
            add_part(part, count, sums);
        }
        write_scores(sums, count, score + first);
        for (int i = 0; i < count; ++i)
            log[first + i] = natural_log(std::max(sums.density[i], least_of_sum))
                + 0.5 * score[first + i] * score[first + i];
    });
    return result;
}

} // namespace

void bind_normal_scores(py::module_& m)
{
    m.def("normal_scores_of_two", &of_two_normals, "z"_a, "chance"_a, "narrow"_a,
          "wide"_a,
          "((n,) normal scores, (n,) log of the determinant) of residuals that are "
          "narrow or wide.\n\n"
          "z : (n,) residuals. chance : (n,) of being wide, above 0 and below 1.\n"
          "narrow, wide : (n,) variances.");
    m.def("normal_scores_of_rates", &of_rates, "law"_a, "z"_a, "variance"_a, "gain"_a,
          "seconds"_a,
          "((n,) normal scores, (n,) log of the determinant) of residuals of pixels "
          "in which charge\ngathers at rates whose law is a sum of normals.\n\n"
          "law : (3, k) weights, means and variances of rates, 1/s.\n"
          "z : (n,) standardised residuals. variance : (n,), without what rates add.\n"
          "gain : (n,), of charge.");
}

} // namespace cg2raw::python

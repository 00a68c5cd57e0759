// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Estimates with normal errors, of values whose law is a sum of normals: their
/// density and the posterior of each value, which are closed.
#include "normal_mixture.h"

#include "elementary.h"
#include "multiversion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cg2raw::python {
namespace {

/// Estimates with their variance at a value of 0, what a unit of it adds, and what one
/// below 0 takes at most.
struct Estimates {
    const double* value;
    const double* error;
    const double* per_value;
    const double* most_taken;
};

constexpr double log_root_2_pi = 0x1.d67f1c864beb4p-1;

struct Sums {
    double nearest[piece]; ///< least of the exponents of all parts
    double density[piece]; ///< relative to that of the nearest part
    double mean[piece], square[piece]; ///< of the value, times the density
};

double error_at(const Estimates& at, int i, double value)
{
    return at.error[i] + std::max(at.per_value[i] * value, -at.most_taken[i]);
}

CG2RAW_MULTIVERSION
void find_nearest(const Mixture& law, const Estimates& at, int count, Sums& sums)
{
    std::fill_n(sums.nearest, count, std::numeric_limits<double>::infinity());
    for (int part = 0; part < law.parts; ++part) {
        const double mean = law.means[part], variance = law.variances[part];
        for (int i = 0; i < count; ++i) {
            const double away = at.value[i] - mean;
            const double total = variance + error_at(at, i, mean);
            sums.nearest[i] = std::min(sums.nearest[i], 0.5 * away * away / total);
        }
    }
}

CG2RAW_MULTIVERSION
void sum_densities(const Mixture& law, const Estimates& at, int count, Sums& sums)
{
    std::fill_n(sums.density, count, 0.0);
    for (int part = 0; part < law.parts; ++part) {
        const double mean = law.means[part], variance = law.variances[part];
        const double weight = law.weights[part];
        for (int i = 0; i < count; ++i) {
            const double away = at.value[i] - mean;
            const double total = variance + error_at(at, i, mean);
            const double exponent = sums.nearest[i] - 0.5 * away * away / total;
            sums.density[i] += weight / std::sqrt(total)
                * exponential(std::max(exponent, least_exponent));
        }
    }
}

CG2RAW_MULTIVERSION
void sum_values(const Mixture& law, const Estimates& at, int count, Sums& sums)
{
    for (double* const sum : { sums.density, sums.mean, sums.square })
        std::fill_n(sum, count, 0.0);
    for (int part = 0; part < law.parts; ++part) {
        const double mean = law.means[part], variance = law.variances[part];
        const double weight = law.weights[part];
        for (int i = 0; i < count; ++i) {
            const double away = at.value[i] - mean;
            const double error = error_at(at, i, mean);
            const double total = variance + error, kept = variance / total;
            const double exponent = sums.nearest[i] - 0.5 * away * away / total;
            const double share = weight / std::sqrt(total)
                * exponential(std::max(exponent, least_exponent));
            const double value = mean + kept * away;
            sums.density[i] += share;
            sums.mean[i] += share * value;
            sums.square[i] += share * (value * value + kept * error);
        }
    }
}

void log_densities(const Sums& sums, int count, double* to)
{
    for (int i = 0; i < count; ++i)
        to[i] = natural_log(sums.density[i]) - sums.nearest[i] - log_root_2_pi;
}

void posteriors(const Sums& sums, int count, double* mean, double* variance)
{
    for (int i = 0; i < count; ++i) {
        mean[i] = sums.mean[i] / sums.density[i];
        const double square = sums.square[i] / sums.density[i];
        variance[i] = std::max(square - mean[i] * mean[i], 0.0);
    }
}

/// The arguments of both functions.
class Arguments {
public:
    Arguments(const Numbers& law, Numbers estimates)
        : m_law(mixture_of(law))
        , m_estimates(std::move(estimates))
    {
        if (m_estimates.ndim() != 2 || m_estimates.shape(0) != 4)
            throw Error("estimates must be an array of four rows");
    }

    py::ssize_t count() const { return m_estimates.shape(1); }
    const Mixture& law() const { return m_law; }

    Estimates from(py::ssize_t first) const
    {
        const double* const all = m_estimates.data();
        const py::ssize_t row = m_estimates.shape(1);
        return { all + first, all + row + first, all + 2 * row + first,
                 all + 3 * row + first };
    }

private:
    Mixture m_law;
    Numbers m_estimates;
};

Numbers log_density(const Numbers& law, const Numbers& estimates)
{
    const Arguments arguments(law, estimates);
    Numbers result(arguments.count());
    double* const to = result.mutable_data();
    each_piece(arguments.count(), [&](py::ssize_t first, int count) {
        Sums sums;
        const Estimates at = arguments.from(first);
        find_nearest(arguments.law(), at, count, sums);
        sum_densities(arguments.law(), at, count, sums);
        log_densities(sums, count, to + first);
    });
    return result;
}

std::pair<Numbers, Numbers> posterior(const Numbers& law, const Numbers& estimates)
{
    const Arguments arguments(law, estimates);
    std::pair result { Numbers(arguments.count()), Numbers(arguments.count()) };
    double* const mean = result.first.mutable_data();
    double* const variance = result.second.mutable_data();
    each_piece(arguments.count(), [&](py::ssize_t first, int count) {
        Sums sums;
        const Estimates at = arguments.from(first);
        find_nearest(arguments.law(), at, count, sums);
        sum_values(arguments.law(), at, count, sums);
        posteriors(sums, count, mean + first, variance + first);
    });
    return result;
}

} // namespace

void bind_normal_mixture(py::module_& m)
{
    m.def(
        "log_density_of_mixture", &log_density, "law"_a, "estimates"_a,
        "(n,) log density of estimates with normal errors, of values whose law is a "
        "sum of normals.\n\n"
        "law : (3, k) weights, means and variances of the normals.\n"
        "estimates : (4, n) estimates, the variance of each where its value is 0, what "
        "a unit of the value adds, and what one below 0 takes at most.");
    m.def("posterior_of_mixture", &posterior, "law"_a, "estimates"_a,
          "((n,) mean, (n,) variance) of each value, given its estimate. Arguments as "
          "those of\nlog_density_of_mixture.");
}

} // namespace cg2raw::python

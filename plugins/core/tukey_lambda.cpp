// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "tukey_lambda.h"

#include "elementary.h"
#include "multiversion.h"

#include <cmath>

namespace cg2raw {
namespace {

/// Nearer to 0 than this the logistic distribution is nearer to the true one than the
/// difference of two powers: both are within 4e-6 of it, relatively, at any uniform.
constexpr double least_lambda = 1e-7;

/// zeta(k) - 1 for k >= 2: eleven terms, then Euler and Maclaurin's remainder.
double zeta_less_one(int k)
{
    constexpr int last = 12;
    const auto power = [k](double base) { // base^-k
        double result = 1.0;
        for (int i = 0; i < k; ++i)
            result /= base;
        return result;
    };
    double sum = 0.0;
    for (int n = 2; n < last; ++n)
        sum += power(n);
    const double tail = power(last), bend = k / (12.0 * last);
    const double next = k * (k + 1.0) * (k + 2.0) / (720.0 * last * last * last);
    return sum + tail * (last / (k - 1.0) + 0.5 + bend - next);
}

CG2RAW_MULTIVERSION void add_logistic(const double* uniform, const double* scale,
                                      int count, float* noise)
{
    for (int i = 0; i < count; ++i) {
        const double q = natural_log(uniform[i]) - natural_log(1.0 - uniform[i]);
        noise[i] += float(scale[i] * q);
    }
}

CG2RAW_MULTIVERSION void add_powers(const double* uniform, const double* scale,
                                    double lambda, int count, float* noise)
{
    const double reciprocal = 1.0 / lambda;
    for (int i = 0; i < count; ++i) {
        const double q = exponential(lambda * natural_log(uniform[i]))
            - exponential(lambda * natural_log(1.0 - uniform[i]));
        noise[i] += float(scale[i] * (q * reciprocal));
    }
}

} // namespace

/// The known formula 2 / lambda^2 (1 / (1 + 2 lambda) - B(1 + lambda, 1 + lambda))
/// loses all digits at lambda = 0. By ln Gamma(1 + x) = -ln(1 + x) + (1 - gamma) x
/// + sum over k >= 2 of (zeta(k) - 1) (-x)^k / k (Abramowitz and Stegun, 6.1.33),
/// B = exp(-T) / (1 + lambda)^2, and T, of order lambda^2, has a series without a
/// cancellation.
double tukey_lambda_variance(double lambda)
{
    constexpr int terms = 44; // 0.5^44 / 44 = 1e-15
    double t = 0.0; // T / lambda^2
    double power = 1.0; // (-lambda)^(k - 2)
    double two = 4.0; // 2^k
    for (int k = 2; k < terms; ++k) {
        t += zeta_less_one(k) * (two - 2.0) / k * power;
        power *= -lambda;
        two *= 2.0;
    }
    double ratio = 1.0; // (1 - exp(-T)) / T, by Taylor; T stays below 0.4
    for (int n = 20; n >= 2; --n)
        ratio = 1.0 - t * lambda * lambda / n * ratio;
    const double twice = 1.0 + 2.0 * lambda, square = (1.0 + lambda) * (1.0 + lambda);
    return 2.0 * (1.0 + twice * t * ratio) / (twice * square);
}

void add_tukey_lambda(const double* uniform, const double* scale, double lambda,
                      int count, float* noise)
{
    if (std::abs(lambda) < least_lambda)
        add_logistic(uniform, scale, count, noise);
    else
        add_powers(uniform, scale, lambda, count, noise);
}

} // namespace cg2raw

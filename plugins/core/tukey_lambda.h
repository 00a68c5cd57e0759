// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Tukey's lambda distribution: symmetric, of mean 0, its tails set by lambda.
/// 0: logistic; 0.14: almost normal; below: heavier tails, without a variance from
/// -0.5 on. Source: B. L. Joiner and J. R. Rosenblatt, J. Am. Stat. Assoc. 66(334),
/// 1971.
#pragma once

#include "cg2raw/effect.h"

namespace cg2raw {

/// Shape with the tails nearest to a normal's. Source: J. J. Filliben, Technometrics
/// 17(1), 1975.
constexpr double normal_lambda = 0.14;

/// Whether values of heavy_tailed_noise are drawn from normals: outliers in a normal
/// are a mixture of normals, which Tukey's almost is not. Its last three values are
/// lambda, share and variance ratio of the outliers.
inline bool has_normal_core(const Values& values)
{
    return *(values.end() - 2) > 0.0 && *(values.end() - 3) == normal_lambda;
}

/// Variance of the distribution of scale 1, for -0.5 < lambda <= 0.5; relative error
/// below 1e-9.
double tukey_lambda_variance(double lambda);

/// noise[i] += scale[i] Q(uniform[i]) with the quantile function
/// Q(u) = (u^lambda - (1 - u)^lambda) / lambda. Uniforms of 52 bits cut the tails: at
/// lambda = -0.4 that takes 1.2e-3 of the variance, from -0.3 on less than 2e-6.
void add_tukey_lambda(const double* uniform, const double* scale, double lambda,
                      int count, float* noise);

} // namespace cg2raw

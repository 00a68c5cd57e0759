// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Noise of the read-out whose tails are not Gaussian: Tukey's lambda
/// distribution of a given variance, or a mixture of two that differ in variance.
#include "cg2raw/effect.h"
#include "cg2raw/profile.h"

#include "site_pieces.h"
#include "site_rows.h"
#include "tukey_lambda.h"

#include <cmath>

namespace cg2raw::effects {
namespace {

/// What stands behind the variances of the CFA's sites.
struct Shape {
    double lambda, outlier_fraction, outlier_variance_ratio;
    bool is_normal;

    explicit Shape(const Values& values)
        : lambda(*(values.end() - shapes))
        , outlier_fraction(*(values.end() - 2))
        , outlier_variance_ratio(values.back())
        , is_normal(has_normal_core(values))
    {
    }

    static constexpr int shapes = 3;
    bool has_outliers() const { return outlier_fraction > 0.0; }
    /// Variance of all draws over that of those that are no outliers.
    double spread() const
    {
        return 1.0 + outlier_fraction * (outlier_variance_ratio - 1.0);
    }
};

void add_core(const SitePiece& piece, const double* scale, const Shape& shape,
              const Rng& rng)
{
    if (shape.is_normal) {
        float normal[most_in_piece];
        rng.normals(piece.at, piece.count, normal);
        for (int i = 0; i < piece.count; ++i)
            piece.noise[i] += float(scale[i] * double(normal[i]));
        return;
    }
    double uniform[most_in_piece];
    rng.uniforms(piece.at, piece.count, uniform);
    add_tukey_lambda(uniform, scale, shape.lambda, piece.count, piece.noise);
}

void draw(Signal& signal, const Values& values, const Rng& rng)
{
    const Shape shape(values);
    const double of_core = shape.is_normal ? 1.0 : tukey_lambda_variance(shape.lambda);
    Values scales(values.begin(), values.end() - Shape::shapes);
    for (double& value : scales)
        value = std::sqrt(value / (of_core * shape.spread()));
    if (!shape.has_outliers()) {
        each_piece_of_sites(signal, scales, [&](const SitePiece& piece) {
            add_core(piece, piece.value, shape, rng);
        });
        return;
    }
    const Rng deciding = rng.other("outliers");
    const double widening = std::sqrt(shape.outlier_variance_ratio);
    each_piece_of_sites(signal, scales, [&](const SitePiece& piece) {
        double uniform[most_in_piece], scale[most_in_piece];
        deciding.uniforms(piece.at, piece.count, uniform);
        for (int i = 0; i < piece.count; ++i)
            scale[i] = uniform[i] < shape.outlier_fraction ? piece.value[i] * widening
                                                           : piece.value[i];
        add_core(piece, scale, shape, rng);
    });
}

} // namespace

Effect heavy_tailed_noise()
{
    auto parameters = per_site("beta2", "1", 0.0, 1.0, "variance at a CFA site");
    parameters.push_back({ "tukey_lambda", "1", least_tukey_lambda, most_tukey_lambda,
                           normal_lambda,
                           "shape: 0.14 almost normal, and normal where there are "
                           "outliers; below it heavier tails" });
    parameters.push_back({ "outlier_fraction", "1", 0.0, most_outliers, 0.0,
                           "part of the draws that are wider, all of them together "
                           "as wide as before" });
    parameters.push_back({ "outlier_variance_ratio", "1", 1.0,
                           most_outlier_variance_ratio, 1.0,
                           "variance of an outlier over that of the others" });
    return { "heavy_tailed_noise",
             Stage::readout,
             Pattern::temporal,
             parameters,
             "read-out noise with the tails of Tukey's lambda distribution, and "
             "outliers",
             "K. Wei et al., IEEE Trans. PAMI 44(11), 2022",
             add_site_variance,
             draw };
}

} // namespace cg2raw::effects

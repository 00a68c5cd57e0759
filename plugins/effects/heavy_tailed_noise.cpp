// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Noise of the read-out whose tails are not Gaussian: Tukey's lambda
/// distribution of a given variance.
#include "cg2raw/effect.h"

#include "site_pieces.h"
#include "site_rows.h"
#include "tukey_lambda.h"

#include <cmath>

namespace cg2raw::effects {
namespace {

/// Shape with the tails nearest to a normal's. Source: J. J. Filliben, Technometrics
/// 17(1), 1975.
constexpr double normal_lambda = 0.14;

void draw(Signal& signal, const Values& values, const Rng& rng)
{
    const double lambda = values.back(), variance = tukey_lambda_variance(lambda);
    Values scales(values.begin(), values.end() - 1);
    for (double& value : scales)
        value = std::sqrt(value / variance);
    each_piece_of_sites(signal, scales, [&](const SitePiece& piece) {
        double uniform[most_in_piece];
        rng.uniforms(piece.at, piece.count, uniform);
        add_tukey_lambda(uniform, piece.value, lambda, piece.count, piece.noise);
    });
}

} // namespace

Effect heavy_tailed_noise()
{
    auto parameters = per_site("beta2", "1", 0.0, 1.0, "variance at a CFA site");
    parameters.push_back({ "tukey_lambda", "1", least_tukey_lambda, most_tukey_lambda,
                           normal_lambda,
                           "shape: 0.14 almost normal, below it heavier tails" });
    return { "heavy_tailed_noise",
             Stage::readout,
             Pattern::temporal,
             parameters,
             "read-out noise with the tails of Tukey's lambda distribution",
             "K. Wei et al., IEEE Trans. PAMI 44(11), 2022",
             add_site_variance,
             draw };
}

} // namespace cg2raw::effects

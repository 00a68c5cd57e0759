// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Photon noise as it is: whole electrons, Poisson distributed. shot_noise is its
/// Gaussian limit.
#include "cg2raw/effect.h"

#include "poisson.h"
#include "site_pieces.h"
#include "site_rows.h"

#include <algorithm>

namespace cg2raw::effects {
namespace {

static_assert(most_in_piece <= poisson_piece);

void draw(Signal& signal, const Values& beta1, const Rng& rng)
{
    each_piece_of_sites(signal, beta1, [&rng](const SitePiece& piece) {
        double electrons[most_in_piece], drawn[most_in_piece];
        for (int i = 0; i < piece.count; ++i)
            electrons[i]
                = piece.value[i] > 0.0 ? double(piece.mean[i]) / piece.value[i] : 0.0;
        poisson_counts(rng, piece.at, electrons, piece.count, drawn);
        for (int i = 0; i < piece.count; ++i) {
            const double light = std::max(electrons[i], 0.0);
            piece.noise[i] += float((drawn[i] - light) * piece.value[i]);
        }
    });
}

} // namespace

Effect poisson_shot_noise()
{
    return { "poisson_shot_noise",
             Stage::noise,
             Pattern::temporal,
             per_site("beta1", "1", 0.0, 1.0, "signal of one electron at a CFA site"),
             "photon noise: whole electrons, Poisson distributed",
             "K. Wei et al., IEEE Trans. PAMI 44(11), 2022",
             add_photon_variance,
             draw };
}

} // namespace cg2raw::effects

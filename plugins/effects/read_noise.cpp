// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Noise of the read-out, Gaussian: the same variance at every signal.
#include "cg2raw/effect.h"

#include "site_pieces.h"
#include "site_rows.h"

#include <cmath>

namespace cg2raw::effects {
namespace {

/// By itself, where it is not white: see read_noise_correlation.
void draw_apart(Signal& signal, const Values& values, const Rng& rng)
{
    Values deviations = values;
    for (double& value : deviations)
        value = std::sqrt(value);
    each_piece_of_sites(signal, deviations, [&](const SitePiece& piece) {
        float normal[most_in_piece];
        rng.normals(piece.at, piece.count, normal);
        for (int i = 0; i < piece.count; ++i)
            piece.noise[i] += float(piece.value[i] * double(normal[i]));
    });
}

} // namespace

Effect read_noise()
{
    Effect effect { "read_noise",
                    Stage::readout,
                    Pattern::temporal,
                    per_site("beta2", "1", 0.0, 1.0, "variance at a CFA site"),
                    "read-out noise: a variance that does not depend on the signal",
                    "A. Foi et al., IEEE Trans. Image Process. 17(10), 2008",
                    add_site_variance };
    effect.draw_apart = draw_apart;
    return effect;
}

} // namespace cg2raw::effects

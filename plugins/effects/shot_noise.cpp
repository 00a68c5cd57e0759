// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Photon noise, in the Gaussian limit: its variance is in proportion to the
/// signal.
#include "cg2raw/effect.h"

#include "site_rows.h"

namespace cg2raw::effects {

Effect shot_noise()
{
    return { "shot_noise",
             Stage::noise,
             Pattern::temporal,
             per_site("beta1", "1", 0.0, 1.0, "variance per signal at a CFA site"),
             "photon noise: variance grows in proportion to the signal",
             "A. Foi et al., IEEE Trans. Image Process. 17(10), 2008",
             add_photon_variance };
}

} // namespace cg2raw::effects

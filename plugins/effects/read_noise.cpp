// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Noise of the read-out, Gaussian: the same variance at every signal.
#include "cg2raw/effect.h"

#include "site_rows.h"

namespace cg2raw::effects {

Effect read_noise()
{
    return { "read_noise",
             Stage::readout,
             Pattern::temporal,
             per_site("beta2", "1", 0.0, 1.0, "variance at a CFA site"),
             "read-out noise: a variance that does not depend on the signal",
             "A. Foi et al., IEEE Trans. Image Process. 17(10), 2008",
             add_site_variance };
}

} // namespace cg2raw::effects

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Noise of the read-out, Gaussian: the same variance at every signal.
#include "cg2raw/effect.h"

#include "site_rows.h"

namespace cg2raw::effects {
namespace {

void expect(Signal& signal, const Values& beta2)
{
    each_row_of_sites(
        signal, beta2,
        [](const float*, float* variance, const float* offset, int width) {
            for (int col = 0; col < width; ++col)
                variance[col] += offset[col & 1];
        });
}

} // namespace

Effect read_noise()
{
    return { "read_noise",
             Stage::noise,
             Pattern::temporal,
             per_site("beta2", "1", 0.0, 1.0, "variance at a CFA site"),
             "read-out noise: a variance that does not depend on the signal",
             "A. Foi et al., IEEE Trans. Image Process. 17(10), 2008",
             expect };
}

} // namespace cg2raw::effects

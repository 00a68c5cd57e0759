// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file A response that bends: the pixel's capacitance and its source follower change
/// with the signal.
#include "cg2raw/effect.h"

#include "multiversion.h"

#include <algorithm>

namespace cg2raw::effects {
namespace {

/// Beyond this signal the response is a straight line again.
constexpr float last_bend = 1.3f;

CG2RAW_MULTIVERSION void bend(float quadratic, float cubic, int count, float* mean)
{
    for (int i = 0; i < count; ++i) {
        const float u = std::min(std::max(mean[i], 0.0f), last_bend);
        mean[i] -= u * u * (quadratic + cubic * u);
    }
}

void predict(Signal& signal, const Values& values)
{
    for (int row = 0; row < signal.mean[0].height; ++row)
        bend(float(values[0]), float(values[1]), signal.mean[0].width,
             signal.mean[0].row(row));
}

} // namespace

Effect nonlinearity()
{
    return { "nonlinearity",
             Stage::response,
             Pattern::none,
             { { "quadratic", "1", -1.0, 1.0, 0.0, "loss at white, growing as x^2" },
               { "cubic", "1", -1.0, 1.0, 0.0, "loss at white, growing as x^3" } },
             "a response that is not in proportion to the light",
             "F. Wang, A. Theuwissen, Proc. IS&T Electronic Imaging, IMSE, 2017",
             predict };
}

} // namespace cg2raw::effects

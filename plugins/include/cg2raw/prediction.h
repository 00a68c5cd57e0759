// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What effects are predicted to do to blocks of a frame, without a scene: for
/// fits, which ask it thousands of times.
#pragma once

#include "cg2raw/pipeline.h"

namespace cg2raw {

/// A block of a frame, and where its prediction goes.
struct PredictedBlock {
    Site origin; ///< of the block's first pixel in the active area, margin included
    std::array<Plane<const float>, 3> camera; ///< as it enters stage color
    /// Without the margin: the signal before quantisation, 0..1 above black and beyond;
    /// its variance over frames, in the square of that; and the signal before its
    /// noise.
    Plane<float> mean, variance, exposed;
};

/// Predicts every block as a physical sensor takes it: nothing is clipped that no
/// effect clips, and noise falls on every site. Fixed patterns are those of the
/// profile's sensor. @p settings are all effects, in any order. The same bytes for any
/// ParallelFor.
///
/// @p margin pixels around each block are read and not predicted. Throws Error for bad
/// settings, for blocks that leave the frame, if an effect needs what @p exposure
/// lacks, and if effects reach beyond the margin of a block that the frame goes on
/// around.
void predict_blocks(const SensorProfile& profile,
                    const std::vector<NamedValues>& settings, const Exposure& exposure,
                    const std::vector<PredictedBlock>& blocks, int margin,
                    const ParallelFor& parallel);

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What effects are predicted to do to blocks of a frame, without a scene: for
/// fits, which ask it thousands of times.
#pragma once

#include "cg2raw/effect.h"
#include "cg2raw/parallel.h"
#include "cg2raw/run.h"

#include <array>

namespace cg2raw {

/// A block of a frame, without its margin.
struct PredictedBlock {
    Site origin; ///< of the first pixel, in the active area
    Size size;
    /// As it enters stage color: the block with its margin, moved into the frame where
    /// that would leave it.
    std::array<Plane<const float>, 3> camera;
    /// Where the prediction goes: the signal before quantisation, 0..1 above black and
    /// beyond; its variance over frames, in the square of that; and the signal before
    /// its noise.
    Plane<float> mean, variance, exposed;
};

/// First pixel of the camera RGB of a block whose first pixel is @p origin.
Site first_of_block(Site origin, Size block, int margin, Size frame);

/// Predicts every block as a physical sensor takes it: nothing is clipped that no
/// effect clips, and noise falls on every site. Fixed patterns are those of the
/// profile's sensor. @p settings are all effects, in any order. The same bytes for any
/// ParallelFor.
///
/// The glare context, where an effect needs it, is that of the camera RGB as it is
/// given, before the effects of stage color.
///
/// @p margin pixels around each block are read and not predicted; where the frame ends
/// within them, effects mirror there as they do in the whole frame. Throws Error for
/// bad settings, for blocks that leave the frame, if an effect needs what @p exposure
/// lacks, and if effects reach beyond the margin on a side where the frame goes on.
void predict_blocks(const SensorProfile& profile,
                    const std::vector<NamedValues>& settings, const Exposure& exposure,
                    const std::vector<PredictedBlock>& blocks, int margin,
                    const ParallelFor& parallel);

} // namespace cg2raw

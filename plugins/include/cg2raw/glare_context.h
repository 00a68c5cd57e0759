// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file A whole frame in few cells, for effects that scatter light far.
#pragma once

#include "cg2raw/color.h"
#include "cg2raw/types.h"

#include <array>
#include <vector>

namespace cg2raw {

/// The whole frame as a block of it knows it: camera RGB as it enters the optics,
/// in few cells.
struct GlareContext {
    Size cells;
    std::array<std::vector<float>, 3> wide; ///< spread over a sixth of the height
    Vec3 mean; ///< of the frame
};

/// The glare context of a frame of camera RGB, in cells of the same size that are about
/// square, 64 across: cell i of n holds pixels i W / n ... (i + 1) W / n - 1. It is
/// spread by a Gaussian whose sigma is a sixth of the height, mirrored at the borders.
GlareContext glare_context_of(const std::array<Plane<const float>, 3>& camera);

} // namespace cg2raw

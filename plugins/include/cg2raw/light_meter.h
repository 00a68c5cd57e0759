// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The light meter that an exposure is chosen by.
#pragma once

#include "cg2raw/frame.h"

namespace cg2raw {

/// The run with its meter read: the luminance of a percentile of all pixels, in units
/// of the value 1. Pixels that are not finite, or are black, do not count. It is the
/// same for any ParallelFor. A run without a meter is returned as it is. Throws Error.
Run metered(const SensorProfile& profile, Run run, Size frame, const SceneRows& rows,
            const ParallelFor& parallel);

} // namespace cg2raw

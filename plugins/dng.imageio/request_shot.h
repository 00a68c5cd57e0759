// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What an image says of its exposure and of its place in a shot.
#pragma once

#include "attributes.h"

namespace cg2raw {

/// The Exif that renderers and oiiotool put into an image; its FramesPerSecond,
/// smpte:TimeCode, reelName and cameraLabel, unless @p attributes say others. @p frame
/// is its number. Throws Error for a time code without a rate, and for one whose first
/// frame is not said.
Shot shot_of(const OIIO::ImageSpec& spec, const Attributes& attributes,
             std::int64_t frame);

} // namespace cg2raw

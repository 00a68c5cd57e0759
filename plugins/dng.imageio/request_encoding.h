// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What the numbers of an image mean, as its ImageSpec says it.
#pragma once

#include "attributes.h"
#include "cg2raw/encoding.h"
#include "cg2raw/scene_file.h"

namespace cg2raw {

/// The name of the colour space that a host states; empty if it states none.
std::string color_space_of(const OIIO::ImageSpec& spec);

/// The type of the samples in the file that was read, as far as a host says it: what it
/// states is the type to write. OpenEXR, whose every file has a screenWindowWidth, has
/// floats.
std::string samples_of(const OIIO::ImageSpec& spec);

/// The way from the host's pixels of @p layer to light. @p is_raw: whether their colour
/// space is a RAW space. Throws Error, with the remedy, for pixels that are neither RAW
/// nor scene-linear Rec.709 then.
Decoder decoder_of(const OIIO::ImageSpec& spec, const Attributes& attributes,
                   const SceneLayer& layer, bool is_raw);

} // namespace cg2raw

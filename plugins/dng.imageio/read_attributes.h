// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What a DNG says, as attributes of an ImageSpec; and the hints to its reader.
#pragma once

#include "cg2raw/dng_mosaic.h"

#include <OpenImageIO/imageio.h>

namespace cg2raw {

/// Adds what the file says of its camera, its shot and its pixels: OpenImageIO's and
/// Exif's own names where there are such, else "raw:" and the name of the DNG's tag.
/// Not "dng:", which ask our writer for something.
void add_attributes(const DngMetadata& metadata, const DngStorage& storage,
                    OIIO::ImageSpec& spec);

/// Whether the configuration asks for a developed picture by dng:developed, 0 or 1.
/// Throws Error for other values and for other hints that begin with "dng:".
bool wants_developed(const OIIO::ImageSpec& config);

} // namespace cg2raw

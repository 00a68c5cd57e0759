// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What an ImageSpec asks for, in the words of the core.
#pragma once

#include "cg2raw/dng_writer.h"

#include <OpenImageIO/imageio.h>

namespace cg2raw {

/// Everything that decides a file, from the attributes of the image.
struct Request {
    SensorProfile profile;
    Run run;
    DngOptions options;
    Shot shot;
};

/// Reads dng:* attributes, oiio:ColorSpace, oiio:BitsPerSample and Exif. Throws Error
/// for an unknown dng: attribute, a value out of range, a contradiction, or a colour
/// space that is neither RAW nor scene-linear Rec.709.
Request request_of(const OIIO::ImageSpec& spec);

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What an ImageSpec asks for, in the words of the core.
#pragma once

#include "cg2raw/dng_writer.h"
#include "cg2raw/encoding.h"
#include "cg2raw/scene_file.h"
#include "cg2raw/spectral_image.h"

#include <OpenImageIO/imageio.h>

namespace cg2raw {

/// Everything that decides a file, from the attributes of the image.
struct Request {
    SceneLayer layer; ///< the channels to take
    Decoder decoder; ///< of their numbers
    std::optional<SpectralResponse> spectral; ///< of spectra, which are taken instead
    SensorProfile profile;
    Run run;
    DngOptions options;
    Shot shot;
};

/// Reads dng:* attributes, the names of channels, the type of samples, oiio:ColorSpace,
/// oiio:UnassociatedAlpha, oiio:BitsPerSample, smpte:TimeCode and Exif. The frame
/// number is dng:frame, else that in @p file's name, else the time code, else 0. Throws
/// Error for an unknown dng: attribute, a value out of range, a contradiction, channels
/// that are no picture, or a colour space that is neither RAW nor scene-linear Rec.709.
Request request_of(const OIIO::ImageSpec& spec, const std::string& file);

} // namespace cg2raw

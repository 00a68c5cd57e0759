// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The dng:* attributes of an image, checked one by one.
#pragma once

#include "cg2raw/dng_writer.h"

#include <OpenImageIO/imageio.h>

namespace cg2raw {

/// The attributes as they were given; absent ones are empty.
struct Attributes {
    std::string sensor, reference, illuminant, layer;
    std::optional<double> iso, gain, exposure;
    std::optional<bool> highlights;
    std::optional<Convention> convention;
    std::optional<NoiseModel> noise;
    std::optional<Compression> compression;
    bool sample_gain = false;
    bool linearize = false; ///< undo the curve of sRGB
    std::uint64_t seed = 0;
    std::optional<std::int64_t> frame;
    std::optional<FrameRate> frame_rate;
    std::optional<TimeCode> time_code; ///< of first_frame
    std::optional<std::int64_t> first_frame;
    std::string reel, camera_label;
    bool effects = true;
    DngOptions options;
};

/// Throws Error naming attribute, value and what is allowed.
Attributes attributes_of(const OIIO::ImageSpec& spec);

} // namespace cg2raw

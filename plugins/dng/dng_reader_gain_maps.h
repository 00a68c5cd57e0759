// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Shading, the reciprocal of GainMaps, where the maps have their points.
#pragma once

#include "cg2raw/dng_reader.h"

namespace cg2raw {

/// A place in the frame: rows and columns over its height and width, 0 to 1.
struct Place {
    double v, h;
};

struct ShadingAt {
    Place at;
    double shading; ///< mean over CFA sites and files
};

struct GainMapSamples {
    /// Those of the first file's first map that lie in the frame, without any at which
    /// a gain is hopeless.
    std::vector<ShadingAt> points;
    /// Rms of the ratio to the mean, less 1: over the sites, over the files.
    double between_sites = 0.0, between_files = 0.0;
};

/// Of @p files, one or more, with one or more maps each.
GainMapSamples gain_map_samples(const std::vector<const DngMetadata*>& files);

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Shading, the reciprocal of GainMaps, where the maps have their points, and how
/// it differs between colours.
#pragma once

#include "cg2raw/dng_reader.h"

#include <array>
#include <optional>
#include <vector>

namespace cg2raw {

/// A place in the frame: rows and columns over its height and width, 0 to 1.
struct Place {
    double v, h;
};

/// Whether @p map corrects pixels at a place, within a step of its pitch.
bool covers(const GainMapAt& map, Place at, Size size);

using SiteGains = std::array<double, 36>;

/// The product of all gains that each site of the CFA gets at a place. @p gain_at is
/// asked once a map, as a file may have many sites and maps.
template <class GainAt>
SiteGains site_gains(const DngMetadata& file, Place at, const GainAt& gain_at)
{
    SiteGains gains;
    gains.fill(1.0);
    for (const GainMapAt& map : file.gain_maps) {
        if (!covers(map, at, file.active_area))
            continue;
        const double gain = gain_at(map, at);
        for (int site : map.sites)
            gains[std::size_t(site)] *= gain;
    }
    return gains;
}

/// As little as there are points: a file may have as many as it has bytes.
struct ShadingAt {
    int row, col; ///< of the grid
    double shading; ///< mean over CFA sites and files
    float red, blue; ///< such means over these sites, as fractions of green's
};

struct GainMapSamples {
    /// Those of the first file's first map that lie in the frame, without any at which
    /// a gain is hopeless.
    std::vector<ShadingAt> points;
    const GainMapAt* grid; ///< that first map
    CfaPattern cfa;
    /// Rms of the ratio to the mean, less 1: over the sites, over the files.
    double between_sites = 0.0, between_files = 0.0;
};

/// Of @p files, one or more, with one or more maps each.
GainMapSamples gain_map_samples(const std::vector<const DngMetadata*>& files);

Place place_of(const GainMapSamples& samples, const ShadingAt& point);
/// A place as the effects know it: from the centre, in half diagonals of the frame.
struct FieldOffset {
    double u, v;
};
FieldOffset field_offset(Place at, Size size);
/// The mean over the sites of green and files.
double green_shading(const GainMapSamples& samples, const ShadingAt& point);

/// What color_shading makes of the maps.
struct ColorShadingFit {
    std::vector<double> values; ///< in the effect's order
    /// Rms over red and blue: of their ratio to green over its mean, less 1; and what
    /// the effect leaves of it.
    double departure = 0.0, rms = 0.0;
};

/// Nothing if the points do not determine the parameters, if red and blue are shaded as
/// green is, or if they differ from it in another way than the effect can.
std::optional<ColorShadingFit> color_shading_fit(const GainMapSamples& samples,
                                                 Size size);

} // namespace cg2raw

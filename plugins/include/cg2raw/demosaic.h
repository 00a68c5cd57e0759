// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The way back from a mosaic: one CFA plane -> camera RGB.
#pragma once

#include "cg2raw/profile.h"

#include <array>
#include <vector>

namespace cg2raw {

/// The two colours that each site lacks, by normalised convolution with a tent: means
/// of the colour's sites around, by nearness. The tent is the smallest that finds every
/// colour everywhere: bilinear interpolation for Bayer patterns. It takes what lies
/// inside the image, so that a constant stays one to its edges. Without filters all
/// three are the site's own. Source: H. Knutsson,
/// C.-F. Westin, Normalized and Differential Convolution, CVPR 1993.
class Demosaic {
public:
    /// Throws Error if an image of that size holds no whole repeat of the CFA.
    Demosaic(const CfaPattern& cfa, Size size);

    /// Row @p row of a mosaic of that size -> three planes of camera RGB.
    void row(const Plane<const float>& raw, int row, float* const camera[3]) const;

private:
    struct Tap {
        int row, col; ///< from the site that is filled
        float weight;
    };
    using Taps = std::vector<Tap>;

    Taps taps(Site at, int color, int radius) const;
    float mean_around(const Plane<const float>& raw, Site at, int color) const;

    CfaPattern m_cfa;
    Size m_size;
    int m_radius;
    std::vector<std::array<Taps, 3>> m_taps; ///< per CFA site, for sites inside
};

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The picture of a mosaic that stands in the file beside it.
#pragma once

#include "cg2raw/dng_writer.h"

namespace cg2raw {

/// 8-bit sRGB, at most 1024 pixels long: each pixel is the mean of a block of the CFA's
/// repeats, white-balanced by the neutral. Rows arrive from top to bottom and picture
/// rows leave so; memory is that of a few rows. Sums are integers: the same bytes
/// however rows arrive.
class Preview {
public:
    /// The mosaic holds at least one repeat of its CFA.
    explicit Preview(const DngDescription& description);

    Size size() const { return m_size; }
    /// The next rows of the mosaic, DN. Returns the picture rows that they complete: R,
    /// G, B, row major, until the next call.
    const std::vector<std::uint8_t>& add_rows(const Plane<const std::uint16_t>& rows,
                                              const ParallelFor& parallel);

private:
    /// How a site's sum adds to its colour: 0 at black, 1 at white, over all sites of
    /// it.
    struct SiteScale {
        int color;
        float per_dn, black;
    };
    /// DN, one per row of the CFA's repeat and column of the mosaic.
    using Sums = std::vector<std::uint32_t>;
    /// One row of the picture, balanced camera RGB.
    using CameraRow = std::array<std::vector<float>, 3>;

    /// Adds @p rows, the first of which is row @p first of its block.
    void add(const Plane<const std::uint16_t>& rows, int first, Sums& sums) const;
    /// Renders @p sums as row @p row of those that leave.
    void finish(const Sums& sums, int row);
    CameraRow balanced(const Sums& sums) const;
    void render(CameraRow& camera, std::uint8_t* out) const;

    CfaPattern m_cfa;
    int m_width; ///< of the mosaic
    Size m_block; ///< mosaic pixels per picture pixel, multiples of the repeat
    Size m_size;
    std::vector<SiteScale> m_sites;
    std::array<float, 9> m_srgb_from_balanced;
    std::vector<std::uint8_t> m_curve; ///< of sRGB: linear 0..1 -> code
    int m_row = 0; ///< of the mosaic
    Sums m_sums; ///< of a block row that began in an earlier call
    std::vector<std::uint8_t> m_pixels; ///< of the rows that leave
};

} // namespace cg2raw

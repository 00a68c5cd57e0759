// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Where the samples of a mosaic lie in its file; private to the reader.
#pragma once

#include "cg2raw/dng_mosaic.h"

#include "tiff/reader.h"

namespace cg2raw {

/// Strips or tiles, here all called chunks: checked, so that all lie inside the file
/// and can hold what they should.
struct DngLayout {
    DngStorage storage;
    Size chunk; ///< pixels; strips are as wide as the image
    bool is_tiled; ///< tiles are whole, beyond the image too; the last strip ends there
    int across, down; ///< chunks
    std::vector<std::int64_t> offsets, byte_counts; ///< row major
    std::vector<std::uint16_t> linearization; ///< empty: none

    /// Rows of the chunks of row @p down_index.
    int rows_of(int down_index) const;
    /// Bytes of one row of an uncompressed chunk.
    std::uint64_t row_bytes() const;
};

/// @p raw looks into the raw IFD, @p main into IFD0. Throws Error.
DngLayout read_dng_layout(const TiffReader& file, const TiffTags& raw,
                          const TiffTags& main);

} // namespace cg2raw

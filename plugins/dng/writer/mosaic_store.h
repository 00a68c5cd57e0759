// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file How the mosaic's rows become strips or tiles of the file.
#pragma once

#include "cg2raw/dng_writer.h"
#include "tiff/file.h"

#include <algorithm>
#include <memory>

namespace cg2raw {

/// Takes rows from top to bottom and keeps as many as one row of strips or tiles holds.
class MosaicStore {
public:
    virtual ~MosaicStore() = default;
    virtual Storage storage() const = 0;
    /// Whole strips or tiles go to @p file, whose IFD has that storage.
    virtual void write_rows(TiffFile& file, const Plane<const std::uint16_t>& rows) = 0;
};

/// Strips or tiles by @p compression; a mosaic below 16 columns, the least width of a
/// tile, stays uncompressed: dcraw wraps a tile that is wider than the image.
std::unique_ptr<MosaicStore> mosaic_store(const DngDescription& description,
                                          Compression compression,
                                          ParallelFor parallel);

/// Rows are handed on in groups of @p rows_per_group: from the caller's memory where a
/// whole group is there, else from a copy that grows until it is whole.
class RowGroups {
public:
    RowGroups(Size size, int rows_per_group);

    int rows_per_group() const { return m_rows_per_group; }

    /// @p take is called with each group that is complete; the last may be lower.
    template <class Take> void add(const Plane<const std::uint16_t>& rows, Take take)
    {
        for (int row = 0; row < rows.height;) {
            const int group = std::min(m_rows_per_group, m_size.height - m_first_row);
            const int count = std::min(group - m_copied, rows.height - row);
            const Plane<const std::uint16_t> part { rows.row(row), rows.width, count,
                                                    rows.pitch };
            row += count;
            if (count == group) {
                take(part);
            } else {
                copy(part);
                if (m_copied < group)
                    continue;
                take(Plane<const std::uint16_t> { m_copy.data(), m_size.width, group,
                                                  m_size.width });
            }
            m_first_row += group;
            m_copied = 0;
        }
    }

private:
    void copy(const Plane<const std::uint16_t>& rows);

    Size m_size;
    int m_rows_per_group;
    int m_first_row = 0; ///< of the group that is open
    int m_copied = 0; ///< rows of it in the copy
    std::vector<std::uint16_t> m_copy;
};

} // namespace cg2raw

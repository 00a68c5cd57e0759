// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Blocks of a mosaic in any order -> rows from top to bottom.
#pragma once

#include "cg2raw/types.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace cg2raw {

/// Counts which pixels of a frame are there.
class RowCount {
public:
    explicit RowCount(Size size)
        : m_size(size)
    {
    }

    /// A block whose first pixel is @p at. Throws Error for pixels outside the frame,
    /// and for rows that get more pixels than they have.
    void add(Site at, Size block);
    /// Rows from the top that are complete.
    int complete() const { return m_complete; }

private:
    Size m_size;
    int m_complete = 0;
    std::vector<int> m_filled; ///< pixels that each row has; empty before the first
};

/// Passes rows on as soon as all above them are there. Rows that come in order cost no
/// memory; the first block out of order allocates the frame.
class RowAssembly {
public:
    using Sink = std::function<void(const Plane<const std::uint16_t>&)>;

    RowAssembly(Size size, Sink sink);

    /// A block whose first pixel is @p at. Throws Error for pixels outside the frame,
    /// or of rows that were complete already.
    void put(Site at, const Plane<const std::uint16_t>& block);
    /// Rows passed on so far.
    int rows_done() const { return m_done; }

private:
    Size m_size;
    Sink m_sink;
    int m_done = 0;
    RowCount m_count;
    std::vector<std::uint16_t> m_frame;
};

} // namespace cg2raw

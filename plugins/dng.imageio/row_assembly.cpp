// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "row_assembly.h"

#include <algorithm>
#include <string>

namespace cg2raw {

void RowCount::add(Site at, Size block)
{
    if (at.row < 0 || at.col < 0 || at.row + block.height > m_size.height
        || at.col + block.width > m_size.width)
        throw Error("pixels at row " + std::to_string(at.row) + ", column "
                    + std::to_string(at.col) + " are outside the image");
    if (at.row < m_complete)
        throw Error("row " + std::to_string(at.row) + " was written already");
    m_filled.resize(std::size_t(m_size.height));
    for (int row = at.row; row < at.row + block.height; ++row) {
        int& filled = m_filled[std::size_t(row)];
        filled += block.width;
        if (filled > m_size.width)
            throw Error("row " + std::to_string(row) + " was written twice");
    }
    while (m_complete < m_size.height
           && m_filled[std::size_t(m_complete)] == m_size.width)
        ++m_complete;
}

RowAssembly::RowAssembly(Size size, Sink sink)
    : m_size(size)
    , m_sink(std::move(sink))
    , m_count(size)
{
}

void RowAssembly::put(Site at, const Plane<const std::uint16_t>& block)
{
    m_count.add(at, { block.width, block.height });
    if (m_frame.empty() && at.row == m_done && block.width == m_size.width) {
        m_sink(block);
        m_done += block.height;
        return;
    }
    const auto width = std::size_t(m_size.width);
    m_frame.resize(width * std::size_t(m_size.height));
    for (int row = 0; row < block.height; ++row)
        std::copy_n(block.row(row), block.width,
                    m_frame.data() + std::size_t(at.row + row) * width
                        + std::size_t(at.col));
    const int end = m_count.complete();
    if (end == m_done)
        return;
    const auto offset = std::size_t(m_done) * width;
    m_sink({ m_frame.data() + offset, m_size.width, end - m_done, m_size.width });
    m_done = end;
}

} // namespace cg2raw

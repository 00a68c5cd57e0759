// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "row_assembly.h"

#include <algorithm>
#include <string>

namespace cg2raw {

RowAssembly::RowAssembly(Size size, Sink sink)
    : m_size(size)
    , m_sink(std::move(sink))
{
}

void RowAssembly::put(Site at, const Plane<const std::uint16_t>& block)
{
    if (at.row < 0 || at.col < 0 || at.row + block.height > m_size.height
        || at.col + block.width > m_size.width)
        throw Error("pixels at row " + std::to_string(at.row) + ", column "
                    + std::to_string(at.col) + " are outside the image");
    if (at.row < m_done)
        throw Error("row " + std::to_string(at.row) + " was written already");
    if (m_frame.empty() && at.row == m_done && block.width == m_size.width) {
        m_sink(block);
        m_done += block.height;
        return;
    }
    keep(at, block);
    pass_on_complete_rows();
}

void RowAssembly::keep(Site at, const Plane<const std::uint16_t>& block)
{
    const auto width = std::size_t(m_size.width);
    m_frame.resize(width * std::size_t(m_size.height));
    m_filled.resize(std::size_t(m_size.height));
    for (int row = 0; row < block.height; ++row) {
        const auto target = std::size_t(at.row + row);
        m_filled[target] += block.width;
        if (m_filled[target] > m_size.width)
            throw Error("row " + std::to_string(target) + " was written twice");
        std::copy_n(block.row(row), block.width,
                    m_frame.data() + target * width + std::size_t(at.col));
    }
}

void RowAssembly::pass_on_complete_rows()
{
    const auto is_complete = [&](int row) {
        return row < m_size.height && m_filled[std::size_t(row)] == m_size.width;
    };
    int end = m_done;
    while (is_complete(end))
        ++end;
    if (end == m_done)
        return;
    const auto offset = std::size_t(m_done) * std::size_t(m_size.width);
    m_sink({ m_frame.data() + offset, m_size.width, end - m_done, m_size.width });
    m_done = end;
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file For effects that look at the pixels around: a plane with a mirrored margin.
#pragma once

#include "cg2raw/types.h"

#include <algorithm>
#include <vector>

namespace cg2raw {

/// The place inside 0 ... size - 1 that @p index is the mirror image of. The first and
/// last pixel are the mirrors and stand once, so that a Bayer mosaic keeps its colours.
inline int mirrored(int index, int size)
{
    if (size == 1)
        return 0;
    const int period = 2 * (size - 1);
    const int place = (index % period + period) % period;
    return std::min(place, period - place);
}

/// A copy of a plane, continued on all sides by its mirror image.
class Margined {
public:
    Margined(const Plane<float>& plane, int margin)
        : m_margin(margin)
        , m_pitch(plane.width + 2 * margin)
        , m_pixels(std::size_t(m_pitch) * std::size_t(plane.height + 2 * margin))
    {
        float* to = m_pixels.data();
        for (int row = -margin; row < plane.height + margin; ++row, to += m_pitch) {
            const float* const from = plane.row(mirrored(row, plane.height));
            std::copy(from, from + plane.width, to + margin);
            for (int i = 1; i <= margin; ++i) {
                to[margin - i] = from[mirrored(-i, plane.width)];
                to[margin + plane.width - 1 + i]
                    = from[mirrored(plane.width - 1 + i, plane.width)];
            }
        }
    }

    /// Of rows -margin ... height + margin - 1; columns likewise.
    const float* row(int row) const
    {
        return m_pixels.data() + std::ptrdiff_t(row + m_margin) * m_pitch + m_margin;
    }
    /// Elements from a pixel to the one below.
    std::ptrdiff_t pitch() const { return m_pitch; }

private:
    int m_margin;
    std::ptrdiff_t m_pitch;
    std::vector<float> m_pixels;
};

} // namespace cg2raw

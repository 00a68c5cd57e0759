// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The words that every stage shares: errors, sites, and views of pixels.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string_view>

namespace cg2raw {

/// Bad input: the message names file, field, value, bound and remedy, in one line. It
/// is UTF-8 without control characters whatever it repeats of a stranger's text, where
/// '?' stands for others, and of one above longest_message bytes the middle is left
/// out.
struct Error : std::runtime_error {
    static constexpr std::size_t longest_message = 1500;
    explicit Error(std::string_view message);
};

/// A pixel's place; row 0, col 0 is the top-left pixel of the active area.
struct Site {
    int row, col;
};

/// Width and height, pixels.
struct Size {
    int width, height;
};

/// Non-owning view of one sensor plane; the pitch counts elements, not bytes.
template <class T> struct Plane {
    T* data;
    int width, height;
    std::ptrdiff_t pitch;

    T* row(int r) const
    {
        assert(r >= 0 && r < height);
        return data + r * pitch;
    }
    /// View of rows first ... first + count - 1.
    Plane rows(int first, int count) const
    {
        assert(first >= 0 && count >= 0 && first + count <= height);
        return { data + first * pitch, width, count, pitch };
    }
    T& operator()(Site at) const
    {
        assert(at.col >= 0 && at.col < width);
        return row(at.row)[at.col];
    }
};

/// Non-owning view of interleaved float pixels whose first three channels are R, G, B;
/// strides count floats.
struct RgbView {
    const float* data;
    int width, height;
    std::ptrdiff_t pixel_stride, row_stride;

    const float* row(int r) const { return data + r * row_stride; }
};

/// Floats of @p count half-precision numbers (IEEE 754 binary16, as their bits); exact.
void float_from_half(const std::uint16_t* half, int count, float* out);

} // namespace cg2raw

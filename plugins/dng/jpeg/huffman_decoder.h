// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The entropy-coded bits of a JPEG, and the differences that they stand for.
#pragma once

#include "cg2raw/types.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace cg2raw {

/// Bits of a scan, highest first, without the zeros that follow each 0xff. Behind the
/// last byte, or the marker that ends the scan, come zeros; overrun() tells.
class BitReader {
public:
    BitReader(const std::uint8_t* begin, const std::uint8_t* end)
        : m_at(begin)
        , m_end(end)
    {
    }

    /// At least @p count bits, up to 32, are in the window.
    void need(int count)
    {
        if (m_fill < count)
            refill();
    }
    /// The next @p count bits, 1 to 32, of those that are there.
    std::uint32_t peek(int count) const
    {
        return std::uint32_t(m_window >> (64 - count));
    }
    void skip(int count)
    {
        m_window <<= count;
        m_fill -= count;
    }
    /// Whether bits were taken that the scan does not have.
    bool overrun() const { return m_fill < m_padding; }

private:
    void refill();

    const std::uint8_t *m_at, *m_end;
    std::uint64_t m_window = 0; ///< from the top
    int m_fill = 0; ///< bits in it
    int m_padding = 0; ///< of them, behind the end of the scan
};

/// A table of a DHT segment.
class HuffmanDecoder {
public:
    /// @p counts codes of 1 to 16 bits, their @p values in order: sizes of differences,
    /// 0 to 16. Throws Error for more codes than fit, and for other sizes.
    HuffmanDecoder(const std::uint8_t counts[16], const std::uint8_t* values,
                   std::size_t value_count);

    /// The next difference, modulo 2^16. Throws Error for bits that are no code.
    std::uint16_t difference(BitReader& bits) const;

private:
    static constexpr int quick_bits = 10;
    struct Code {
        std::uint8_t length = 0; ///< 0: longer than quick_bits, or none
        std::uint8_t size = 0;
    };

    Code slow_code(const BitReader& bits) const;

    std::array<Code, 1 << quick_bits> m_quick {};
    std::array<std::int32_t, 17> m_first {}; ///< code of each length
    std::array<std::int32_t, 17> m_count {};
    std::array<std::int32_t, 17> m_place {}; ///< of that code among the values
    std::array<std::uint8_t, 256> m_sizes {};
};

} // namespace cg2raw

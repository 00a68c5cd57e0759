// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "jpeg/huffman_decoder.h"

#include <algorithm>

namespace cg2raw {

void BitReader::refill()
{
    while (m_fill <= 56) {
        std::uint64_t byte = 0;
        const bool marker
            = m_at != m_end && *m_at == 0xff && (m_at + 1 == m_end || m_at[1] != 0);
        if (m_at == m_end || marker) {
            m_end = m_at;
            m_padding += 8;
        } else {
            byte = *m_at;
            m_at += byte == 0xff ? 2 : 1;
        }
        m_window |= byte << (56 - m_fill);
        m_fill += 8;
    }
    // Zeros that were taken are no longer in the window.
    m_padding = std::min(m_padding, 64 + 8);
}

HuffmanDecoder::HuffmanDecoder(const std::uint8_t counts[16],
                               const std::uint8_t* values, std::size_t value_count)
{
    std::copy_n(values, value_count, m_sizes.begin());
    for (std::size_t i = 0; i < value_count; ++i)
        if (values[i] > 16)
            throw Error("has a Huffman table of sizes up to "
                        + std::to_string(int(values[i]))
                        + " bits; those of differences are 0 to 16");
    std::int32_t code = 0, place = 0;
    for (int length = 1; length <= 16; ++length, code <<= 1) {
        const std::size_t at = std::size_t(length);
        m_first[at] = code;
        m_count[at] = counts[length - 1];
        m_place[at] = place;
        code += m_count[at];
        place += m_count[at];
        if (code > 1 << length)
            throw Error("has a Huffman table of more codes than fit");
        if (length > quick_bits)
            continue;
        const int spare = quick_bits - length;
        for (std::int32_t i = 0; i < m_count[at] << spare; ++i)
            m_quick[std::size_t((m_first[at] << spare) + i)]
                = { std::uint8_t(length),
                    m_sizes[std::size_t(m_place[at] + (i >> spare))] };
    }
}

HuffmanDecoder::Code HuffmanDecoder::slow_code(const BitReader& bits) const
{
    for (int length = quick_bits + 1; length <= 16; ++length) {
        const std::size_t at = std::size_t(length);
        const std::int32_t index = std::int32_t(bits.peek(length)) - m_first[at];
        if (index >= 0 && index < m_count[at])
            return { std::uint8_t(length), m_sizes[std::size_t(m_place[at] + index)] };
    }
    throw Error("has bits that are no code of its Huffman table");
}

std::uint16_t HuffmanDecoder::difference(BitReader& bits) const
{
    bits.need(32); // a code and the difference's own bits
    Code code = m_quick[bits.peek(quick_bits)];
    if (code.length == 0)
        code = slow_code(bits);
    bits.skip(code.length);
    if (code.size == 0)
        return 0;
    if (code.size == 16) // its size alone. T.81, H.1.2.2
        return 32768;
    const std::uint32_t own = bits.peek(code.size);
    bits.skip(code.size);
    const bool negative = (own >> (code.size - 1)) == 0;
    return std::uint16_t(negative ? own + 1 - (1U << code.size) : own);
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The Huffman code of lossless JPEG's difference sizes, made for one histogram.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace cg2raw {

/// Sizes 0 to 16 of a difference, in bits. Source: ITU-T T.81, table H.2.
constexpr int difference_sizes = 17;
using SizeHistogram = std::array<std::uint64_t, difference_sizes>;

/// Bits of the difference itself behind the code of its size: 32768, the only one of
/// size 16, is its size alone. Source: T.81, H.1.2.2.
constexpr unsigned own_bits(int size) { return size == 16 ? 0 : unsigned(size); }

/// A code of 1 to 16 bits per size that occurs; no code is all ones.
struct HuffmanCode {
    std::array<std::uint16_t, difference_sizes> code {};
    std::array<std::uint8_t, difference_sizes> length {}; ///< 0: does not occur
    std::array<std::uint8_t, 16> count_of_length {}; ///< DHT's BITS, from length 1
    std::vector<std::uint8_t> sizes; ///< DHT's HUFFVAL
};

/// The shortest such code for @p histogram, which has a count above 0.
HuffmanCode huffman_code(const SizeHistogram& histogram);

} // namespace cg2raw

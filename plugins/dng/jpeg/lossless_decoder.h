// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Lossless JPEG as DNGs hold it -> samples.
#pragma once

#include "cg2raw/types.h"

#include <cstdint>
#include <vector>

namespace cg2raw {

/// Samples that @p bytes of lossless JPEG can hold at most, a bit each: more are not
/// allocated for.
constexpr std::uint64_t most_jpeg_samples(std::uint64_t bytes) { return 8 * bytes; }

/// The @p count samples of the one scan of a lossless JPEG, in the order of the file:
/// row by row, components interleaved. SOF3 with 1 to 4 components of 2 to 16 bits
/// without subsampling, predictors 1 to 7, Huffman codes; no restart intervals, no
/// point transform.
/// Throws Error that says what the JPEG is or has, without the file's name: also if it
/// is truncated, or has another number of samples.
/// Source: ITU-T T.81 (1992), annexes B, C, F.2.2 and H.
void decode_lossless_jpeg(const std::vector<std::uint8_t>& jpeg, std::uint16_t* out,
                          std::uint64_t count);

} // namespace cg2raw

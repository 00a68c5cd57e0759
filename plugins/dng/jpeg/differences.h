// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What lossless JPEG codes: differences of samples from what predicts them, and
/// the sizes of those.
#pragma once

#include "jpeg/huffman.h"

#include <cstdint>
#include <vector>

namespace cg2raw {

/// A tile's samples in the lines that the JPEG has them in. A line may be several rows
/// of the tile on end: then what is above a sample is that many rows above.
struct JpegLines {
    const std::uint16_t* samples;
    int width; ///< samples of a line, a multiple of the components
    int count;
    int components; ///< 1 or 2, interleaved
};

/// How a tile becomes a JPEG.
struct JpegCoding {
    JpegLines lines;
    int predictor; ///< 1 to 7
};

/// Buffers that are reused.
struct Differences {
    std::vector<std::uint16_t> values; ///< modulo 2^16
    std::vector<std::uint8_t> sizes; ///< of each, 0 to 16: bits of its magnitude
};

/// The differences of all samples from what predicts them; in the first line from the
/// left neighbour, in the others' first column from the one above, at the very first
/// pixel from half the range of @p bits. Source: T.81, H.1.2.1.
void find_differences(const JpegCoding& coding, int bits, Differences& differences);

/// How often each size occurs.
SizeHistogram histogram_of(const std::vector<std::uint8_t>& sizes);

/// Of a tile's samples in lines of one row and in lines of two, and of all predictors:
/// what makes the fewest bits of every eighth line, each with the Huffman code made for
/// it; of equal ones the first. Whole numbers decide: it is the same on any machine.
/// The tile is @p width samples wide, its @p height a multiple of 16. @p scratch is
/// overwritten.
JpegCoding best_coding(const std::uint16_t* samples, int width, int height,
                       int components, Differences& scratch);

} // namespace cg2raw

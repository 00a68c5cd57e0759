// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Lossless JPEG of one tile of a mosaic, as DNG has it.
#pragma once

#include "jpeg/differences.h"

#include "cg2raw/types.h"

#include <cstdint>
#include <vector>

namespace cg2raw {

/// What a sample is predicted by.
enum class Prediction {
    left, ///< predictor 1, the only one that every reader knows
    best, ///< that of predictors 1 to 7 which makes this tile's JPEG the smallest
};

/// Reused between tiles by one thread: the buffers keep their memory.
struct JpegScratch {
    std::vector<std::uint16_t> samples;
    Differences differences;
    std::vector<std::uint8_t> bits;
};

/// One tile of @p tile pixels -> a lossless JPEG: SOF3, two interleaved components, so
/// that a pixel is predicted by its neighbour of the same colour two columns to the
/// left; of a monochrome mosaic, whose @p repeat is 1 x 1, one component, which is what
/// dcraw and LibRaw take a plane without filters to have; one Huffman table, made for
/// this tile. Of Prediction::best two rows may be one line of the JPEG, so that in a
/// Bayer mosaic the pixel above has the same colour, too; the tile's height is a
/// multiple of 16 then.
///
/// @p image is the part of the tile that the image covers, from its top-left corner;
/// beyond it the last pixels repeat in the CFA's rhythm @p repeat. The tile's width is
/// even. The precision is @p bits (2 to 16), more if a value needs more. Lossless for
/// any values.
/// @p jpeg is overwritten. Source: ITU-T T.81 (1992), annexes H, K.2; that a line may
/// be two rows: DNGs of Blackmagic's and of DJI's cameras are so (RawSpeed, issue 189).
void encode_lossless_jpeg(const Plane<const std::uint16_t>& image, Size tile,
                          Size repeat, int bits, Prediction prediction,
                          JpegScratch& scratch, std::vector<std::uint8_t>& jpeg);

} // namespace cg2raw

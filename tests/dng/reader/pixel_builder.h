// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file DNGs with pixels, for tests of the reader: tiny_dng() and its strips or tiles.
#pragma once

#include "cg2raw/types.h"

#include "tiff_builder.h"

namespace cg2raw::test {

/// Rows of @p width samples as TIFF has them: 16 bits in the file's order, others
/// packed from the highest bit on, each row from a byte on.
inline std::string packed(const std::vector<std::uint16_t>& samples, int width,
                          int bits, bool big_endian)
{
    std::string bytes;
    std::uint32_t window = 0;
    int fill = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        std::uint32_t sample = samples[i];
        if (bits == 16 && !big_endian)
            sample = (sample & 0xff) << 8 | sample >> 8;
        window = window << bits | sample;
        fill += bits;
        for (; fill >= 8; fill -= 8)
            bytes += char(window >> (fill - 8));
        if ((i + 1) % std::size_t(width) == 0 && fill > 0) {
            bytes += char(window << (8 - fill));
            fill = 0;
        }
    }
    return bytes;
}

/// One file: the pixels lie behind all directories.
struct PixelDng {
    PixelDng(int bits, std::vector<std::string> chunks_, Size tile_ = { 0, 0 })
        : chunks(std::move(chunks_))
        , tile(tile_)
    {
        ifd.shorts(258, { std::uint64_t(bits) });
    }

    std::string file(bool big_endian = false) const
    {
        std::string pixels;
        std::vector<std::uint64_t> offsets, counts;
        for (const std::string& chunk : chunks) {
            offsets.push_back(shared ? 0 : pixels.size());
            counts.push_back(chunk.size() - shortage);
            if (!shared || pixels.empty())
                pixels += chunk;
        }
        Ifd whole = ifd;
        // The directories' size does not depend on what the offsets are.
        const std::size_t start = with(whole, offsets, counts, big_endian).size();
        for (std::uint64_t& offset : offsets)
            offset += start + move;
        return with(whole, offsets, counts, big_endian) + pixels;
    }

    Ifd ifd = tiny_dng();
    std::vector<std::string> chunks;
    Size tile; ///< 0: strips
    std::uint64_t shortage = 0; ///< of each byte count
    std::uint64_t move = 0; ///< of each offset
    bool shared = false; ///< all chunks are the first

private:
    std::string with(Ifd& whole, const std::vector<std::uint64_t>& offsets,
                     const std::vector<std::uint64_t>& counts, bool big_endian) const
    {
        const bool tiled = tile.width > 0;
        if (tiled)
            whole.longs(322, { std::uint64_t(tile.width) })
                .longs(323, { std::uint64_t(tile.height) });
        whole.longs(tiled ? 324 : 273, offsets).longs(tiled ? 325 : 279, counts);
        return file_of(whole, big_endian);
    }
};

} // namespace cg2raw::test

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Which strips or tiles hold the mosaic, and whether they can.
#include "reader/layout.h"

#include "jpeg/lossless_decoder.h"
#include "reader/metadata_parts.h"

#include <algorithm>

namespace cg2raw {
namespace {

constexpr Bounds image_side { 2, 65535 };
constexpr Bounds sample_bits { 8, 16 };
constexpr Bounds any_word { 0, 0xFFFFFFFF };
constexpr Bounds table_length { 1, 65536 };
constexpr Bounds dn { 0, 65535 };
/// Values of Compression. Source: DNG specification 1.7.1.
constexpr std::int64_t uncompressed = 1, jpeg = 7;
/// As much XMP as a file of ours or a camera's may have; more is damage.
constexpr std::int64_t longest_xmp = 1 << 24;

std::int64_t required(const TiffTags& raw, TiffTag tag, Bounds value)
{
    return raw.integers(tag, { 1, 1 }, value).front();
}

void require_one(const TiffTags& raw, TiffTag tag, const std::string& meaning)
{
    const auto value = raw.integer_or(tag, any_word, 1);
    if (value != 1)
        raw.fail(tag,
                 "is " + std::to_string(value) + "; " + meaning
                     + ", only 1 is read: use LibRaw for this file");
}

bool read_is_jpeg(const TiffTags& raw)
{
    const auto value = raw.integer_or(tag::compression, { 0, 65535 }, uncompressed);
    if (value != uncompressed && value != jpeg)
        raw.fail(tag::compression,
                 "is " + std::to_string(value)
                     + "; readable are 1 (none) and 7 (lossless JPEG): convert the "
                       "file to one of them, or use LibRaw");
    if (value == uncompressed)
        require_one(raw, tag::predictor, "values are differences");
    return value == jpeg;
}

/// Size of the chunks, and the tags of their places.
struct Chunks {
    Size size;
    TiffTag offsets, byte_counts;
};

Chunks read_chunks(const TiffTags& raw, Size image)
{
    constexpr Bounds tile_side { 1, 65536 };
    if (raw.has(tag::tile_offsets))
        return { { int(required(raw, tag::tile_width, tile_side)),
                   int(required(raw, tag::tile_length, tile_side)) },
                 tag::tile_offsets,
                 tag::tile_byte_counts };
    const auto rows
        = raw.integer_or(tag::rows_per_strip, { 1, any_word.high }, image.height);
    return { { image.width, int(std::min<std::int64_t>(rows, image.height)) },
             tag::strip_offsets,
             tag::strip_byte_counts };
}

std::optional<std::array<double, 2>> read_pair(const TiffTags& raw, TiffTag tag)
{
    if (!raw.has(tag))
        return std::nullopt;
    const auto values = raw.numbers(tag, { 2, 2 });
    return { { values[0], values[1] } };
}

DngStorage read_storage(const TiffTags& raw, const TiffTags& main)
{
    DngStorage storage {};
    storage.size = { int(required(raw, tag::image_width, image_side)),
                     int(required(raw, tag::image_length, image_side)) };
    if (raw.has(tag::active_area)) {
        const auto area = raw.integers(tag::active_area, { 4, 4 }, { 0, 65535 });
        storage.active_area = { int(area[0]), int(area[1]) };
    }
    storage.bits = int(required(raw, tag::bits_per_sample, sample_bits));
    storage.is_jpeg = read_is_jpeg(raw);
    storage.is_linearised = raw.has(tag::linearization_table);
    storage.crop_origin = read_pair(raw, tag::default_crop_origin);
    storage.default_scale = read_default_scale(raw);
    storage.crop_size = read_pair(raw, tag::default_crop_size);
    const auto version = main.bytes(tag::dng_version, { 4, 4 });
    std::copy(version.begin(), version.end(), storage.version.begin());
    storage.software = main.text(tag::software);
    storage.date_time = main.text(tag::date_time);
    if (main.has(tag::xmp)) {
        const auto xmp = main.bytes(tag::xmp, { 0, longest_xmp });
        storage.xmp.assign(xmp.begin(), xmp.end());
    }
    return storage;
}

std::vector<std::uint16_t> read_linearization(const TiffTags& raw)
{
    if (!raw.has(tag::linearization_table))
        return {};
    const auto values = raw.integers(tag::linearization_table, table_length, dn);
    return { values.begin(), values.end() };
}

/// Chunk @p i is inside the file, and not smaller than its pixels.
void check_chunk(const TiffReader& file, const TiffTags& raw, const DngLayout& layout,
                 const Chunks& chunks, std::size_t i)
{
    const std::uint64_t offset = std::uint64_t(layout.offsets[i]);
    const std::uint64_t count = std::uint64_t(layout.byte_counts[i]);
    const std::string what = "of chunk " + std::to_string(i) + " is "
        + std::to_string(count) + " bytes at byte " + std::to_string(offset) + " ";
    if (offset > file.size() || count > file.size() - offset)
        raw.fail(chunks.offsets,
                 what + "of a file of " + std::to_string(file.size())
                     + " bytes: it is truncated or damaged");
    const std::uint64_t rows = std::uint64_t(layout.rows_of(int(i) / layout.across));
    const std::uint64_t samples = rows * std::uint64_t(layout.chunk.width);
    const bool holds = layout.storage.is_jpeg ? samples <= most_jpeg_samples(count)
                                              : rows * layout.row_bytes() <= count;
    if (!holds)
        raw.fail(chunks.byte_counts,
                 what + "for " + std::to_string(layout.chunk.width) + " x "
                     + std::to_string(rows)
                     + " pixels, which need more: the file is damaged");
}

/// What overlaps would let a small file ask for a lot of memory.
void check_total(const TiffReader& file, const TiffTags& raw, const DngLayout& layout,
                 const Chunks& chunks)
{
    std::uint64_t left = file.size();
    for (const std::int64_t count : layout.byte_counts) {
        if (std::uint64_t(count) > left)
            raw.fail(chunks.byte_counts,
                     "are together more than the file's " + std::to_string(file.size())
                         + " bytes: chunks overlap, the file is damaged");
        left -= std::uint64_t(count);
    }
}

} // namespace

int DngLayout::rows_of(int down_index) const
{
    return is_tiled
        ? chunk.height
        : std::min(chunk.height, storage.size.height - down_index * chunk.height);
}

std::uint64_t DngLayout::row_bytes() const
{
    return (std::uint64_t(chunk.width) * std::uint64_t(storage.bits) + 7) / 8;
}

DngLayout read_dng_layout(const TiffReader& file, const TiffTags& raw,
                          const TiffTags& main)
{
    DngLayout layout {};
    layout.storage = read_storage(raw, main);
    require_one(raw, tag::fill_order, "bits are in reverse order");
    require_one(raw, tag::row_interleave_factor, "rows are interleaved");
    if (raw.has(tag::sub_tile_block_size)
        && raw.integers(tag::sub_tile_block_size, { 2, 2 }, any_word)
            != std::vector<std::int64_t> { 1, 1 })
        raw.fail(tag::sub_tile_block_size,
                 "is not 1 1; tiles made of blocks are not read: use LibRaw for this "
                 "file");
    const Size image = layout.storage.size;
    const Chunks chunks = read_chunks(raw, image);
    layout.chunk = chunks.size;
    layout.is_tiled = raw.has(tag::tile_offsets);
    layout.across = (image.width + chunks.size.width - 1) / chunks.size.width;
    layout.down = (image.height + chunks.size.height - 1) / chunks.size.height;
    const std::int64_t count = std::int64_t(layout.across) * layout.down;
    layout.offsets = raw.integers(chunks.offsets, { count, count }, any_offset);
    layout.byte_counts = raw.integers(chunks.byte_counts, { count, count }, any_offset);
    for (std::size_t i = 0; i < std::size_t(count); ++i)
        check_chunk(file, raw, layout, chunks, i);
    check_total(file, raw, layout, chunks);
    layout.linearization = read_linearization(raw);
    return layout;
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Rows of a mosaic out of its strips or tiles.
#include "reader/layout.h"

#include "jpeg/lossless_decoder.h"
#include "platform/paths.h"
#include "reader/metadata_parts.h"

#include <algorithm>
#include <exception>
#include <fstream>

namespace cg2raw {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// @p count samples of a row: of 8 or 16 bits in the file's order, of others packed,
/// highest bit first in either order. Source: DNG specification 1.7.1, BitsPerSample.
void unpack(const std::uint8_t* bytes, int bits, bool big_endian, int count,
            std::uint16_t* out)
{
    if (bits == 16) {
        const int high = big_endian ? 0 : 1;
        for (int i = 0; i < count; ++i)
            out[i] = std::uint16_t(bytes[2 * i + high] << 8 | bytes[2 * i + 1 - high]);
        return;
    }
    std::uint32_t window = 0;
    int fill = 0;
    for (int i = 0; i < count; ++i) {
        for (; fill < bits; fill += 8)
            window = window << 8 | *bytes++;
        fill -= bits;
        out[i] = std::uint16_t(window >> fill & ((1U << bits) - 1));
    }
}

/// Runs all tasks, then throws what the first of those that failed threw: threads would
/// end the program.
void each_checked(const ParallelFor& parallel, int count,
                  const std::function<void(int)>& task)
{
    std::vector<std::exception_ptr> errors(std::size_t(count), nullptr);
    parallel(count, [&](int i) {
        try {
            task(i);
        } catch (...) {
            errors[std::size_t(i)] = std::current_exception();
        }
    });
    for (const auto& error : errors)
        if (error)
            std::rethrow_exception(error);
}

} // namespace

struct DngMosaic::State {
    State(std::istream& dng, const std::string& name)
        : metadata(read_dng_stream(dng, name, std::nullopt, &layout))
        , file(dng, name)
    {
    }

    /// Rows @p first to @p last of chunk row @p down, into @p rows.
    void read(int down, int first, const Plane<std::uint16_t>& rows,
              const ParallelFor& parallel)
    {
        if (layout.storage.is_jpeg) {
            decode(down, parallel);
            copy(first, rows);
        } else {
            for (int i = 0; i < layout.across; ++i)
                read_uncompressed(down, i, first, rows);
        }
        if (layout.linearization.empty())
            return;
        const std::size_t last = layout.linearization.size() - 1;
        for (int row = 0; row < rows.height; ++row)
            for (int col = 0; col < rows.width; ++col) {
                std::uint16_t& value = rows({ row, col });
                value = layout.linearization[std::min<std::size_t>(value, last)];
            }
    }

    /// Rows of chunk @p i of a row of chunks; @p first counts within the chunk.
    void read_uncompressed(int down, int i, int first,
                           const Plane<std::uint16_t>& rows) const
    {
        const std::uint64_t pitch = layout.row_bytes();
        const std::uint64_t offset = std::uint64_t(layout.offsets[index(down, i)])
            + std::uint64_t(first) * pitch;
        const Bytes bytes = file.bytes(offset, std::uint64_t(rows.height) * pitch);
        const int left = i * layout.chunk.width;
        const int width = std::min(layout.chunk.width, rows.width - left);
        for (int row = 0; row < rows.height; ++row)
            unpack(bytes.data() + std::uint64_t(row) * pitch, layout.storage.bits,
                   file.big_endian(), width, rows.row(row) + left);
    }

    /// All of a row of chunks, unless it is there.
    void decode(int down, const ParallelFor& parallel)
    {
        if (down == decoded_row)
            return;
        decoded_row = -1;
        const std::size_t samples = chunk_samples(down);
        decoded.resize(samples * std::size_t(layout.across));
        std::vector<Bytes> jpegs;
        for (int i = 0; i < layout.across; ++i)
            jpegs.push_back(
                file.bytes(std::uint64_t(layout.offsets[index(down, i)]),
                           std::uint64_t(layout.byte_counts[index(down, i)])));
        each_checked(parallel, layout.across, [&](int i) {
            try {
                decode_lossless_jpeg(jpegs[std::size_t(i)],
                                     decoded.data() + samples * std::size_t(i),
                                     samples);
            } catch (const Error& error) {
                const std::size_t chunk = index(down, i);
                throw Error(file.name() + ": JPEG of chunk " + std::to_string(chunk)
                            + " at byte " + std::to_string(layout.offsets[chunk]) + " "
                            + error.what());
            }
        });
        decoded_row = down;
    }

    void copy(int first, const Plane<std::uint16_t>& rows) const
    {
        const std::size_t samples = chunk_samples(decoded_row);
        const std::size_t width = std::size_t(layout.chunk.width);
        for (int i = 0; i < layout.across; ++i) {
            const int left = i * layout.chunk.width;
            const int count = std::min(layout.chunk.width, rows.width - left);
            for (int row = 0; row < rows.height; ++row)
                std::copy_n(decoded.data() + samples * std::size_t(i)
                                + width * std::size_t(first + row),
                            count, rows.row(row) + left);
        }
    }

    std::size_t index(int down, int i) const
    {
        return std::size_t(down) * std::size_t(layout.across) + std::size_t(i);
    }
    std::size_t chunk_samples(int down) const
    {
        return std::size_t(layout.chunk.width) * std::size_t(layout.rows_of(down));
    }

    DngLayout layout {};
    DngMetadata metadata;
    TiffReader file;
    int decoded_row = -1; ///< of chunks, whose samples are kept; -1: none
    std::vector<std::uint16_t> decoded; ///< chunk after chunk
};

DngMosaic::DngMosaic(std::istream& dng, const std::string& name)
    : m_state(std::make_unique<State>(dng, name))
{
}

DngMosaic::~DngMosaic() = default;

const DngMetadata& DngMosaic::metadata() const { return m_state->metadata; }

const DngStorage& DngMosaic::storage() const { return m_state->layout.storage; }

void DngMosaic::read_rows(int first, const Plane<std::uint16_t>& rows,
                          const ParallelFor& parallel)
{
    const DngLayout& layout = m_state->layout;
    const Size size = layout.storage.size;
    if (first < 0 || rows.height < 0 || rows.width != size.width
        || rows.height > size.height - first)
        throw Error(m_state->file.name() + ": rows " + std::to_string(first) + " to "
                    + std::to_string(first + rows.height) + " of "
                    + std::to_string(rows.width) + " pixels are not inside the "
                    + std::to_string(size.width) + " x " + std::to_string(size.height)
                    + " mosaic");
    const int chunk = layout.chunk.height;
    for (int row = 0; row < rows.height;) {
        const int within = (first + row) % chunk;
        const int count = std::min(rows.height - row, chunk - within);
        m_state->read((first + row) / chunk, within, rows.rows(row, count), parallel);
        row += count;
    }
}

bool is_dng(std::istream& bytes) noexcept
{
    try {
        const TiffReader file(bytes, "");
        const TiffIfd ifd0 = file.held_entries(file.first_ifd());
        const TiffTags main(file, { &ifd0 });
        return main.has(tag::dng_version) || main.has(tag::dng_backward_version);
    } catch (...) {
        return false;
    }
}

bool is_dng(const std::string& path) noexcept
{
    try {
        std::ifstream bytes(path_of(path), std::ios::binary);
        return is_dng(bytes);
    } catch (...) {
        return false;
    }
}

} // namespace cg2raw

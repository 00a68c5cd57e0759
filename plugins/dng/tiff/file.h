// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file libtiff, writing into an AtomicFile. All that touches libtiff goes through
/// here.
#pragma once

#include "tiff/atomic_file.h"
#include "tiff/tag_values.h"

#include <memory>
#include <optional>

struct tiff;

namespace cg2raw {

struct TiffClient;

/// How an IFD's pixels are stored.
struct Storage {
    std::uint32_t width, height;
    std::uint16_t samples, bits;
    std::uint16_t photometric; ///< of tag_numbers.h
    std::uint16_t compression; ///< 1 = none, 7 = JPEG
    std::uint32_t rows_per_strip = 0; ///< 0: tiles
    std::uint32_t tile_width = 0, tile_height = 0;
};

/// A classic little-endian TIFF. Every member throws Error with the file's name and,
/// where there is one, the system's reason. Nothing is printed, and no handler,
/// extender or other state of libtiff is set that a host program shares.
class TiffFile {
public:
    TiffFile(const std::string& path, bool sync);
    ~TiffFile();

    /// An Exif IFD; its offset in the file, for begin(). Before any other IFD.
    std::uint64_t write_exif(const Tags& tags);
    /// Start IFD 0, with the Exif IFD at @p exif if there is one.
    void begin(const Storage& storage, const Tags& tags,
               std::optional<std::uint64_t> exif, bool has_sub_ifd);
    /// Start the SubIFD of IFD 0.
    void begin_sub_ifd(const Storage& storage, const Tags& tags);
    /// Bytes of strip or tile @p index, as they stand in the file; in rising order.
    /// Those of the same one again follow the earlier ones.
    void write_chunk(std::uint32_t index, const void* data, std::size_t size);
    std::uint64_t chunk_offset(std::uint32_t index) const;
    /// The IFD goes to the file.
    void end();

    /// Bytes in place of earlier ones.
    void patch(std::uint64_t offset, const void* data, std::size_t size);
    /// The file appears under its name.
    void publish();

private:
    void store(const Storage& storage, const Tags& tags);
    void patch_rationals(std::uint32_t directory, const Tags& tags);
    /// Place in the file of the value of @p number, or of the value's offset.
    std::uint64_t entry_value(std::uint32_t directory, std::uint32_t number);
    void make_long(std::uint64_t value);
    std::uint32_t word_at(std::uint64_t offset, std::size_t size);
    void need(bool success);

    struct Close {
        void operator()(tiff* handle) const;
    };

    AtomicFile m_file;
    std::unique_ptr<TiffClient> m_client;
    std::unique_ptr<tiff, Close> m_tiff; ///< last: closing it writes to the others
    Tags m_tags; ///< of the IFD that is open
    std::vector<std::uint32_t> m_pointers; ///< tags of it that point to other IFDs
    bool m_tiled = false;
    bool m_sub_ifd = false;
};

} // namespace cg2raw

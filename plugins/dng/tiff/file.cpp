// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "tiff/file.h"

#include "cg2raw/types.h"
#include "tiff/client.h"

#include <tiffio.h>

namespace cg2raw {

namespace {

/// Place of IFD 0's offset in a classic TIFF, after byte order and 42.
constexpr std::uint64_t first_ifd_offset = 4;

} // namespace

void TiffFile::Close::operator()(tiff* handle) const { close_tiff(handle); }

TiffFile::TiffFile(const std::string& path, bool sync)
    : m_file(path, sync)
    , m_client(std::make_unique<TiffClient>(m_file))
    , m_tiff(open_tiff(*m_client))
{
    need(m_tiff != nullptr);
}

TiffFile::~TiffFile() = default;

/// libtiff also complains where it goes on, as with a field that it has lost.
void TiffFile::need(bool success)
{
    const bool complains = m_client->complaint.front() != '\0';
    if (success && !complains)
        return;
    // Unless the system refused to write, libtiff had no memory. It may then keep
    // pointers that were never set, and would free them: it stays as it is.
    if (!m_file.has_failed()) {
        [[maybe_unused]] const TIFF* const left_alone = m_tiff.release();
    }
    m_file.fail("write", complains ? m_client->complaint.data() : "not enough memory");
}

std::uint64_t TiffFile::write_exif(const Tags& tags)
{
    std::uint64_t offset = 0;
    need(TIFFCreateEXIFDirectory(m_tiff.get()) == 0);
    for (const Tag& tag : tags)
        need(set_tag(m_tiff.get(), tag));
    need(TIFFWriteCustomDirectory(m_tiff.get(), &offset) == 1);
    patch_rationals(std::uint32_t(offset), tags);
    // Back to the fields of an image; libtiff would forget the others without freeing
    // them.
    TIFFFreeDirectory(m_tiff.get());
    need(TIFFCreateDirectory(m_tiff.get()) == 0);
    return offset;
}

void TiffFile::begin(const Storage& storage, const Tags& tags,
                     std::optional<std::uint64_t> exif, bool has_sub_ifd)
{
    store(storage, tags);
    if (exif) {
        m_pointers.push_back(TIFFTAG_EXIFIFD);
        need(TIFFSetField(m_tiff.get(), TIFFTAG_EXIFIFD, *exif) == 1);
    }
    if (has_sub_ifd) {
        m_pointers.push_back(TIFFTAG_SUBIFD);
        std::uint64_t unknown_yet = 0;
        need(TIFFSetField(m_tiff.get(), TIFFTAG_SUBIFD, 1, &unknown_yet) == 1);
        std::uint16_t count = 0;
        std::uint64_t* offsets = nullptr; // none if there was no memory for it
        need(TIFFGetField(m_tiff.get(), TIFFTAG_SUBIFD, &count, &offsets) == 1
             && offsets);
    }
}

void TiffFile::begin_sub_ifd(const Storage& storage, const Tags& tags)
{
    store(storage, tags);
    m_sub_ifd = true;
}

void TiffFile::store(const Storage& storage, const Tags& tags)
{
    tiff* const tif = m_tiff.get();
    const auto put = [&](std::uint32_t number, std::uint32_t value) {
        need(TIFFSetField(tif, number, value) == 1);
    };
    m_tags = tags;
    m_tiled = storage.rows_per_strip == 0;
    put(TIFFTAG_IMAGEWIDTH, storage.width);
    put(TIFFTAG_IMAGELENGTH, storage.height);
    put(TIFFTAG_SAMPLESPERPIXEL, storage.samples);
    put(TIFFTAG_BITSPERSAMPLE, storage.bits);
    put(TIFFTAG_COMPRESSION, storage.compression);
    put(TIFFTAG_PHOTOMETRIC, storage.photometric);
    put(TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    if (m_tiled) {
        put(TIFFTAG_TILEWIDTH, storage.tile_width);
        put(TIFFTAG_TILELENGTH, storage.tile_height);
    } else {
        put(TIFFTAG_ROWSPERSTRIP, storage.rows_per_strip);
    }
    for (const Tag& tag : tags)
        need(set_tag(tif, tag));
}

void TiffFile::write_chunk(std::uint32_t index, const void* data, std::size_t size)
{
    const auto write = m_tiled ? TIFFWriteRawTile : TIFFWriteRawStrip;
    // libtiff does not change raw data that is in the machine's byte order.
    const tmsize_t done
        = write(m_tiff.get(), index, const_cast<void*>(data), tmsize_t(size));
    need(done == tmsize_t(size));
}

std::uint64_t TiffFile::chunk_offset(std::uint32_t index) const
{
    return TIFFGetStrileOffset(m_tiff.get(), index);
}

void TiffFile::end()
{
    need(TIFFWriteDirectory(m_tiff.get()) == 1);
    std::uint32_t directory = word_at(first_ifd_offset, 4);
    if (m_sub_ifd)
        directory = word_at(entry_value(directory, TIFFTAG_SUBIFD), 4);
    for (const std::uint32_t pointer : m_pointers)
        make_long(entry_value(directory, pointer));
    m_pointers.clear();
    patch_rationals(directory, m_tags);
}

void TiffFile::patch(std::uint64_t offset, const void* data, std::size_t size)
{
    need(m_file.write(data, size, offset));
}

void TiffFile::publish()
{
    need(true);
    m_tiff.reset();
    m_file.publish();
}

std::uint32_t TiffFile::word_at(std::uint64_t offset, std::size_t size)
{
    std::uint16_t half = 0;
    std::uint32_t word = 0;
    void* const to = size == 2 ? static_cast<void*>(&half) : &word;
    if (m_file.read(to, size, offset) != size)
        m_file.fail("write", "what was written cannot be read back");
    return size == 2 ? half : word;
}

std::uint64_t TiffFile::entry_value(std::uint32_t directory, std::uint32_t number)
{
    // IFD: a count of entries, then 12 bytes each: tag, type, count, value or its
    // offset.
    const std::uint32_t entries = word_at(directory, 2);
    for (std::uint32_t i = 0; i < entries; ++i) {
        const std::uint64_t entry
            = std::uint64_t(directory) + 2 + 12 * std::uint64_t(i);
        if (word_at(entry, 2) == number)
            return entry + 8;
    }
    m_file.fail("write", "libtiff dropped tag " + std::to_string(number));
}

/// libtiff points to IFDs by type IFD. That is legal, but cameras write LONG, which is
/// all that Exif allows, and exiftool warns of the other.
void TiffFile::make_long(std::uint64_t value)
{
    const std::uint16_t type = TIFF_LONG;
    constexpr std::uint64_t from_type_to_value = 6;
    patch(value - from_type_to_value, &type, sizeof type);
}

/// libtiff takes rationals as float32 and finds fractions near to those. Ours are
/// exact, with the denominators that raw converters expect, so they replace libtiff's.
void TiffFile::patch_rationals(std::uint32_t directory, const Tags& tags)
{
    const auto replace = [&](std::uint32_t number, const auto& values) {
        static_assert(sizeof values[0] == 8,
                      "numerator and denominator, as TIFF has them");
        const std::uint32_t at = word_at(entry_value(directory, number), 4);
        patch(at, values.data(), 8 * values.size());
    };
    for (const Tag& tag : tags) {
        if (const auto* values = std::get_if<std::vector<Rational>>(&tag.value))
            replace(tag.number, *values);
        if (const auto* values = std::get_if<std::vector<SignedRational>>(&tag.value))
            replace(tag.number, *values);
    }
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "tiff/reader.h"

#include <utility>

namespace cg2raw {
namespace {

constexpr std::uint16_t classic_tiff = 42, big_tiff = 43;
constexpr std::size_t header_size = 8, entry_size = 12;

} // namespace

std::size_t tiff_value_size(std::uint16_t type)
{
    constexpr std::size_t sizes[] = { 0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4 };
    return type < sizeof sizes / sizeof *sizes ? sizes[type] : 0;
}

TiffReader::TiffReader(std::istream& stream, std::string name)
    : m_bytes(stream)
    , m_name(std::move(name))
{
    m_bytes.seekg(0, std::ios::end);
    const std::streamoff size = m_bytes.tellg();
    m_size = size > 0 ? std::uint64_t(size) : 0;
    if (m_size < header_size)
        throw Error(
            m_name + ": has " + std::to_string(m_size)
            + " bytes; a DNG has at least 8: it is empty, truncated or no file");
    const auto header = bytes(0, header_size);
    m_big_endian = header[0] == 'M';
    if (header[0] != header[1] || (header[0] != 'I' && header[0] != 'M'))
        throw Error(m_name + ": does not start with II or MM: it is not a DNG");
    const std::uint64_t magic = number(&header[2], 2);
    if (magic == big_tiff)
        throw Error(m_name
                    + ": is a BigTIFF; only classic TIFF is read: convert it to a"
                      " DNG below 4 GB");
    if (magic != classic_tiff)
        throw Error(m_name + ": has TIFF version " + std::to_string(magic)
                    + " where a DNG has 42: it is not a DNG");
    m_first_ifd = std::uint32_t(number(&header[4], 4));
}

TiffIfd TiffReader::ifd(std::uint64_t offset, const std::string& what) const
{
    const std::string where
        = m_name + ": " + what + " at byte " + std::to_string(offset) + " ";
    const std::string beyond = "reaches beyond the file's " + std::to_string(m_size)
        + " bytes: the file is truncated or damaged";
    if (offset < header_size || offset + 2 > m_size)
        throw Error(where + beyond);
    const std::size_t count = std::size_t(number(bytes(offset, 2).data(), 2));
    if (count == 0)
        throw Error(where
                    + "has no entries; an IFD has at least 1: the file is damaged");
    if (offset + 2 + count * entry_size > m_size)
        throw Error(where + "with " + std::to_string(count) + " entries " + beyond);
    const auto table = bytes(offset + 2, count * entry_size);
    TiffIfd entries(count);
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint8_t* const entry = &table[i * entry_size];
        entries[i]
            = { std::uint16_t(number(entry, 2)), std::uint16_t(number(entry + 2, 2)),
                std::uint32_t(number(entry + 4, 4)), offset + 2 + i * entry_size + 8 };
    }
    return entries;
}

std::optional<std::vector<std::uint8_t>>
TiffReader::values(const TiffEntry& entry) const
{
    const std::uint64_t size = std::uint64_t(tiff_value_size(entry.type)) * entry.count;
    if (size == 0)
        return std::nullopt;
    const std::uint64_t offset
        = size <= 4 ? entry.field : number(bytes(entry.field, 4).data(), 4);
    if (offset + size > m_size)
        return std::nullopt;
    return bytes(offset, size);
}

std::vector<std::uint8_t> TiffReader::bytes(std::uint64_t offset,
                                            std::uint64_t size) const
{
    if (offset > m_size || size > m_size - offset)
        throw Error(m_name + ": needs " + std::to_string(size) + " bytes at byte "
                    + std::to_string(offset) + " of its " + std::to_string(m_size)
                    + ": the file is truncated or damaged");
    std::vector<std::uint8_t> result(size);
    m_bytes.clear();
    m_bytes.seekg(std::streamoff(offset));
    m_bytes.read(reinterpret_cast<char*>(result.data()), std::streamsize(size));
    if (m_bytes.gcount() != std::streamsize(size))
        throw Error(m_name + ": cannot be read at byte " + std::to_string(offset)
                    + ": check the disk, or that nothing is writing the file");
    return result;
}

std::uint64_t TiffReader::number(const std::uint8_t* bytes, std::size_t size) const
{
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i)
        value = value << 8 | bytes[m_big_endian ? i : size - 1 - i];
    return value;
}

} // namespace cg2raw

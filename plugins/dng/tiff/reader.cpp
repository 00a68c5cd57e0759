// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "tiff/reader.h"

#include <algorithm>
#include <utility>

namespace cg2raw {
namespace {

constexpr std::uint16_t classic_tiff = 42, big_tiff = 43;
constexpr std::uint64_t most_entries = 65535; ///< that a classic TIFF can count

} // namespace

std::size_t tiff_value_size(std::uint16_t type)
{
    constexpr std::size_t sizes[]
        = { 0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4, 0, 0, 8, 8, 8 };
    return type < sizeof sizes / sizeof *sizes ? sizes[type] : 0;
}

TiffReader::TiffReader(std::istream& stream, std::string name)
    : m_bytes(stream)
    , m_name(std::move(name))
{
    m_bytes.seekg(0, std::ios::end);
    const std::streamoff size = m_bytes.tellg();
    m_size = size > 0 ? std::uint64_t(size) : 0;
    if (m_size < classic_form.header)
        throw Error(
            m_name + ": has " + std::to_string(m_size)
            + " bytes; a DNG has at least 8: it is empty, truncated or no file");
    const auto header = bytes(0, classic_form.header);
    m_big_endian = header[0] == 'M';
    if (header[0] != header[1] || (header[0] != 'I' && header[0] != 'M'))
        throw Error(m_name + ": does not start with II or MM: it is not a DNG");
    const std::uint64_t magic = number(&header[2], 2);
    if (magic != classic_tiff && magic != big_tiff)
        throw Error(m_name + ": has TIFF version " + std::to_string(magic)
                    + " where a DNG has 42, or 43 as a BigTIFF: it is not a DNG");
    if (magic == big_tiff)
        m_form = big_form;
    // Before a BigTIFF's offset stand its size, 8, and two zeros.
    const std::size_t at = m_form.header - m_form.value;
    m_first_ifd = number(bytes(at, m_form.value).data(), m_form.value);
}

std::uint64_t TiffReader::entry_count(std::uint64_t offset) const
{
    return number(bytes(offset, m_form.entry_count).data(), m_form.entry_count);
}

TiffIfd TiffReader::ifd(std::uint64_t offset, const std::string& what) const
{
    const std::string where
        = m_name + ": " + what + " at byte " + std::to_string(offset) + " ";
    const std::string beyond = "reaches beyond the file's " + std::to_string(m_size)
        + " bytes: the file is truncated or damaged";
    if (offset < m_form.header || offset > m_size
        || m_form.entry_count > m_size - offset)
        throw Error(where + beyond);
    const std::uint64_t count = entry_count(offset);
    if (count == 0 || count > most_entries)
        throw Error(where + "has " + std::to_string(count)
                    + " entries; an IFD has 1 to 65535: the file is damaged");
    TiffIfd entries = held_entries(offset);
    if (entries.size() < count)
        throw Error(where + "with " + std::to_string(count) + " entries " + beyond);
    return entries;
}

TiffIfd TiffReader::held_entries(std::uint64_t offset) const
{
    const std::uint64_t count = entry_count(offset);
    const std::uint64_t start = offset + m_form.entry_count;
    TiffIfd entries(std::size_t(
        std::min({ count, (m_size - start) / m_form.entry, most_entries })));
    const auto table = bytes(start, entries.size() * m_form.entry);
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const std::uint8_t* const entry = &table[i * m_form.entry];
        entries[i]
            = { std::uint16_t(number(entry, 2)), std::uint16_t(number(entry + 2, 2)),
                number(entry + 4, m_form.value_count),
                start + i * m_form.entry + 4 + m_form.value_count };
    }
    return entries;
}

std::optional<std::vector<std::uint8_t>>
TiffReader::values(const TiffEntry& entry) const
{
    const std::size_t value = tiff_value_size(entry.type);
    if (value == 0 || entry.count == 0 || entry.count > m_size / value)
        return std::nullopt;
    const std::uint64_t size = value * entry.count;
    const std::uint64_t offset = size <= m_form.value
        ? entry.field
        : number(bytes(entry.field, m_form.value).data(), m_form.value);
    if (offset > m_size || size > m_size - offset)
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

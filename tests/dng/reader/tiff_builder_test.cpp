// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "tiff_builder.h"

#include <cstring>

#include <gtest/gtest.h>

namespace cg2raw::test {
namespace {

class File {
public:
    File(bool big_endian, bool is_big_tiff)
        : m_big_endian(big_endian)
        , m_word(is_big_tiff ? 8 : 4)
        , m_bytes(big_endian ? "MM" : "II")
    {
        append(is_big_tiff ? 43 : 42, 2);
        if (is_big_tiff) {
            append(8, 2);
            append(0, 2);
        }
        append(0, m_word);
        m_header = m_bytes.size();
    }

    void append(std::uint64_t word, int size)
    {
        for (int i = 0; i < size; ++i)
            m_bytes += char(word >> 8 * (m_big_endian ? size - 1 - i : i));
    }

    /// Appends values, then the directory; returns the directory's offset.
    std::uint32_t append(const Ifd& ifd)
    {
        std::map<int, Field> fields = ifd.fields;
        add_pointers(fields, 330, ifd.sub_ifds);
        add_pointers(fields, 34665, ifd.exif);
        std::map<int, std::uint32_t> offsets;
        for (const auto& [tag, field] : fields)
            if (field.words.size() * std::size_t(field.word_size)
                > std::size_t(m_word)) {
                offsets[tag] = std::uint32_t(m_bytes.size());
                append_words(field);
            }
        const auto offset = std::uint32_t(m_bytes.size());
        append(fields.size(), m_word == 8 ? 8 : 2);
        for (const auto& [tag, field] : fields) {
            append(std::uint64_t(tag), 2);
            append(field.type, 2);
            append(field.count, m_word);
            const std::size_t end = m_bytes.size() + std::size_t(m_word);
            if (offsets.count(tag))
                append(offsets.at(tag), m_word);
            else
                append_words(field);
            m_bytes.resize(end, '\0');
        }
        append(0, m_word);
        return offset;
    }

    std::string finished(std::uint32_t first_ifd)
    {
        const std::string body = m_bytes.substr(m_header);
        m_bytes.resize(m_header - std::size_t(m_word));
        append(first_ifd, m_word);
        return m_bytes + body;
    }

private:
    void append_words(const Field& field)
    {
        for (std::uint64_t word : field.words)
            append(word, field.word_size);
    }

    void add_pointers(std::map<int, Field>& fields, int tag,
                      const std::vector<Ifd>& ifds)
    {
        std::vector<std::uint64_t> offsets;
        for (const Ifd& ifd : ifds)
            offsets.push_back(append(ifd));
        if (!offsets.empty())
            // LONG or, as libtiff writes it into a BigTIFF, IFD8.
            fields[tag] = { std::uint16_t(m_word == 8 ? 18 : 4),
                            std::uint32_t(offsets.size()), m_word, offsets };
    }

    bool m_big_endian;
    int m_word; ///< bytes of an offset and of a count
    std::string m_bytes;
    std::size_t m_header = 0;
};

Field pairs(std::uint16_t type, const std::vector<std::int64_t>& numerators,
            std::int64_t denominator)
{
    Field field { type, std::uint32_t(numerators.size()), 4, {} };
    for (std::int64_t numerator : numerators) {
        field.words.push_back(std::uint64_t(numerator));
        field.words.push_back(std::uint64_t(denominator));
    }
    return field;
}

} // namespace

Ifd& Ifd::bytes(int tag, const std::vector<std::uint64_t>& values)
{
    fields[tag] = { 1, std::uint32_t(values.size()), 1, values };
    return *this;
}

Ifd& Ifd::shorts(int tag, const std::vector<std::uint64_t>& values)
{
    fields[tag] = { 3, std::uint32_t(values.size()), 2, values };
    return *this;
}

Ifd& Ifd::longs(int tag, const std::vector<std::uint64_t>& values)
{
    fields[tag] = { 4, std::uint32_t(values.size()), 4, values };
    return *this;
}

Ifd& Ifd::text(int tag, const std::string& value)
{
    Field field { 2, std::uint32_t(value.size()), 1, {} };
    for (char c : value)
        field.words.push_back(static_cast<unsigned char>(c));
    fields[tag] = field;
    return *this;
}

Ifd& Ifd::rationals(int tag, const std::vector<std::int64_t>& numerators,
                    std::int64_t denominator)
{
    fields[tag] = pairs(5, numerators, denominator);
    return *this;
}

Ifd& Ifd::fractions(int tag,
                    const std::vector<std::pair<std::uint64_t, std::uint64_t>>& values)
{
    Field field { 5, std::uint32_t(values.size()), 4, {} };
    for (const auto& [numerator, denominator] : values)
        field.words.insert(field.words.end(), { numerator, denominator });
    fields[tag] = field;
    return *this;
}

Ifd& Ifd::signed_rationals(int tag, const std::vector<std::int64_t>& numerators,
                           std::int64_t denominator)
{
    fields[tag] = pairs(10, numerators, denominator);
    return *this;
}

Ifd& Ifd::doubles(int tag, const std::vector<double>& values)
{
    Field field { 12, std::uint32_t(values.size()), 8, {} };
    for (double value : values) {
        std::uint64_t bits = 0;
        std::memcpy(&bits, &value, sizeof bits);
        field.words.push_back(bits);
    }
    fields[tag] = field;
    return *this;
}

Ifd& Ifd::without(int tag)
{
    fields.erase(tag);
    return *this;
}

std::string file_of(const Ifd& ifd0, bool big_endian, bool is_big_tiff)
{
    File file(big_endian, is_big_tiff);
    const std::uint32_t first_ifd = file.append(ifd0);
    return file.finished(first_ifd);
}

Ifd raw_tags()
{
    Ifd ifd;
    ifd.longs(254, { 0 }).longs(256, { 8 }).longs(257, { 6 }).shorts(258, { 16 });
    ifd.shorts(262, { 32803 }).shorts(277, { 1 });
    ifd.shorts(33421, { 2, 2 }).bytes(33422, { 0, 1, 1, 2 });
    ifd.shorts(50713, { 1, 1 }).shorts(50714, { 64 }).shorts(50717, { 1023 });
    return ifd;
}

Ifd camera_tags()
{
    Ifd ifd;
    ifd.text(271, "Maker\0").text(272, std::string("Model 1\0", 8)).shorts(274, { 1 });
    ifd.bytes(50706, { 1, 4, 0, 0 }).bytes(50707, { 1, 3, 0, 0 });
    ifd.text(50708, std::string("Maker Model 1\0", 14));
    ifd.signed_rationals(
        50721, { 7034, -804, -1014, -4420, 12564, 2058, -851, 1994, 5758 }, 10000);
    ifd.rationals(50728, { 522449, 1000000, 571429 }, 1000000);
    ifd.shorts(50778, { 21 });
    return ifd;
}

Ifd tiny_dng()
{
    Ifd ifd = raw_tags();
    ifd.fields.merge(camera_tags().fields);
    return ifd;
}

Ifd tiny_dng_with_sub_ifds()
{
    Ifd ifd = camera_tags();
    ifd.longs(254, { 1 }).shorts(262, { 2 });
    Ifd preview;
    preview.longs(254, { 1 }).shorts(262, { 6 });
    ifd.sub_ifds = { preview, raw_tags() };
    Ifd exif;
    exif.rationals(33434, { 1 }, 60)
        .rationals(33437, { 56 }, 10)
        .shorts(34855, { 400 });
    exif.text(36867, "2019:06:06 07:29:51").rationals(37386, { 65 }, 1);
    exif.text(42036, "EF24-105mm f/4L");
    ifd.exif = { exif };
    return ifd;
}

/// The rest of the reader's tests stand on these bytes.
TEST(ReaderTiffBuilder, WritesBothByteOrders)
{
    Ifd ifd;
    ifd.shorts(258, { 0x1234 });
    EXPECT_EQ(file_of(ifd, false),
              std::string("II\x2A\0\x08\0\0\0\x01\0\x02\x01\x03\0\x01\0\0\0\x34\x12\0\0"
                          "\0\0\0\0",
                          26));
    EXPECT_EQ(file_of(ifd, true),
              std::string("MM\0\x2A\0\0\0\x08\0\x01\x01\x02\0\x03\0\0\0\x01\x12\x34\0\0"
                          "\0\0\0\0",
                          26));
}

} // namespace cg2raw::test

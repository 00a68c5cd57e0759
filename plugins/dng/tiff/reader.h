// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file A small bounded reader of TIFF directories: entries, values, and bytes.
///
/// Why not libtiff, which writes our files: it hands out the RATIONALs of the DNG
/// matrices as 32-bit floats, reads a directory whole and refuses it for a structural
/// tag that we do not need, and allocates what such tags ask for. Here only what is
/// asked for is read, its count is bounded by the caller before anything is allocated,
/// and all 64 bits survive.
#pragma once

#include "cg2raw/types.h"

#include "tiff/tag_numbers.h"

#include <cstdint>
#include <istream>
#include <optional>
#include <string>
#include <vector>

namespace cg2raw {

/// Lowest and highest legal value, both included.
struct Bounds {
    std::int64_t low, high;
};

/// Offsets and sizes, of a BigTIFF too; a double holds each exactly.
constexpr Bounds any_offset { 0, std::int64_t(1) << 53 };

/// One entry of a directory, as it stands in the file: nothing of it is believed yet.
struct TiffEntry {
    std::uint16_t tag, type;
    std::uint64_t count;
    std::uint64_t field; ///< file offset of the entry's bytes of value or offset
};

/// What a RATIONAL is, exactly.
struct Fraction {
    std::int32_t numerator, denominator;
};

using TiffIfd = std::vector<TiffEntry>;

/// Bytes of one value of a TIFF or BigTIFF type, by its number; 0: no such type.
std::size_t tiff_value_size(std::uint16_t type);

/// The bytes of a TIFF, classic or BigTIFF, in either byte order. The stream must
/// outlive it.
class TiffReader {
public:
    /// Throws Error if the header is not one of a TIFF.
    TiffReader(std::istream& bytes, std::string name);

    const std::string& name() const { return m_name; }
    std::uint64_t size() const { return m_size; } ///< of the file, bytes
    bool big_endian() const { return m_big_endian; }
    std::uint64_t first_ifd() const { return m_first_ifd; }
    /// The directory at @p offset; @p what names it in messages. The chain of next
    /// directories is not followed, so a cycle there is harmless.
    /// Throws Error if it is not wholly inside the file.
    TiffIfd ifd(std::uint64_t offset, const std::string& what) const;
    /// Those entries of the directory at @p offset that the file holds, up to 65535:
    /// all that can be known of one that is cut off. Throws Error if it is beyond the
    /// file.
    TiffIfd held_entries(std::uint64_t offset) const;
    /// The bytes of an entry's values, wherever they are; nothing if its type is
    /// unknown or they reach beyond the file.
    std::optional<std::vector<std::uint8_t>> values(const TiffEntry& entry) const;
    /// An unsigned number of @p size bytes, in the file's order.
    std::uint64_t number(const std::uint8_t* bytes, std::size_t size) const;
    /// Bytes of the file. Throws Error, before anything is allocated, if it does not
    /// hold them.
    std::vector<std::uint8_t> bytes(std::uint64_t offset, std::uint64_t size) const;

private:
    /// Bytes of the fields in which the two forms of TIFF differ.
    struct Form {
        std::size_t header, entry_count, entry, value_count, value;
    };

    std::uint64_t entry_count(std::uint64_t offset) const;

    static constexpr Form classic_form { 8, 2, 12, 4, 4 }, big_form { 16, 8, 20, 8, 8 };

    std::istream& m_bytes;
    std::string m_name;
    std::uint64_t m_size = 0;
    bool m_big_endian = false;
    Form m_form = classic_form;
    std::uint64_t m_first_ifd = 0;
};

/// Tags of one or more directories, the first that has a tag answering; what it hands
/// out has been checked, and what fails the check is an Error with file, tag, value and
/// bound.
class TiffTags {
public:
    TiffTags(const TiffReader& file, std::vector<const TiffIfd*> ifds);

    bool has(TiffTag tag) const { return find(tag) != nullptr; }
    /// As many finite numbers, of any numeric type, as @p count allows.
    std::vector<double> numbers(TiffTag tag, Bounds count) const;
    /// Integers, of integer type, each within @p value.
    std::vector<std::int64_t> integers(TiffTag tag, Bounds count, Bounds value) const;
    /// The one integer of a tag, or @p otherwise if the file does not have the tag.
    std::int64_t integer_or(TiffTag tag, Bounds value, std::int64_t otherwise) const;
    /// Number @p index of a tag if it is there, finite and above 0, as Exif's unknown
    /// values are not.
    std::optional<double> positive(TiffTag tag, std::size_t index = 0) const;
    /// The same of any sign, and 0.
    std::optional<double> finite(TiffTag tag, std::size_t index = 0) const;
    /// The one number of a tag as a fraction, its parts above 0 and below 2^31; of an
    /// integer, over 1. Nothing if the file does not have the tag, or says no such one.
    std::optional<Fraction> fraction(TiffTag tag) const;
    /// Of all values of a tag; 1 of integers, infinity of floating point.
    double largest_denominator(TiffTag tag) const;
    /// Text up to its first NUL or, unterminated, to its end; without outer blanks,
    /// control characters and bytes that are no UTF-8. Empty if there is none.
    std::string text(TiffTag tag) const;
    /// The values, undecoded, of a tag of type BYTE or UNDEFINED.
    std::vector<std::uint8_t> bytes(TiffTag tag, Bounds count) const;

    /// Throws Error: "FILE: Tag (number) what".
    [[noreturn]] void fail(TiffTag tag, const std::string& what) const;

private:
    const TiffEntry* find(TiffTag tag) const;
    const TiffEntry& required(TiffTag tag, Bounds count) const;
    std::vector<std::uint8_t> raw_values(TiffTag tag, const TiffEntry& entry) const;
    std::vector<double> decoded(TiffTag tag, const TiffEntry& entry) const;

    const TiffReader& m_file;
    std::vector<const TiffIfd*> m_ifds;
};

} // namespace cg2raw

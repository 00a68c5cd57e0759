// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Values of TIFF tags, checked as they are handed out.
#include "tiff/reader.h"
#include "tiff/text.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace cg2raw {
namespace {

/// TIFF 6.0, section 2; 13 is of its supplement 1, those from 16 on of BigTIFF.
enum TiffType : std::uint16_t {
    type_byte = 1,
    type_ascii = 2,
    type_short = 3,
    type_long = 4,
    type_rational = 5,
    type_sbyte = 6,
    type_undefined = 7,
    type_sshort = 8,
    type_slong = 9,
    type_srational = 10,
    type_float = 11,
    type_double = 12,
    type_ifd = 13,
    type_long8 = 16,
    type_slong8 = 17,
    type_ifd8 = 18,
};

/// No text that we read is longer; a longer one is damage.
constexpr Bounds text_length { 0, 65535 };

std::string shown(Bounds bounds)
{
    if (bounds.low == bounds.high)
        return std::to_string(bounds.low);
    return std::to_string(bounds.low) + " to " + std::to_string(bounds.high);
}

template <class To, class From> To same_bits(From bits)
{
    static_assert(sizeof(To) == sizeof(From));
    To value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
}

/// Zero over zero is DNG's word for unknown, and anything over zero is no number.
double ratio(double numerator, double denominator)
{
    return denominator == 0.0 ? std::numeric_limits<double>::quiet_NaN()
                              : numerator / denominator;
}

/// The number at @p value; NaN if the type holds none.
double decoded_value(const TiffReader& file, std::uint16_t type,
                     const std::uint8_t* value)
{
    const std::uint64_t bits = file.number(value, tiff_value_size(type));
    const auto word
        = [&](std::size_t i) { return std::uint32_t(file.number(value + 4 * i, 4)); };
    switch (type) {
    case type_byte:
    case type_short:
    case type_long:
    case type_ifd:
    case type_long8:
    case type_ifd8:
        return double(bits);
    case type_sbyte:
        return std::int8_t(bits);
    case type_sshort:
        return std::int16_t(bits);
    case type_slong:
        return std::int32_t(bits);
    case type_slong8:
        return double(std::int64_t(bits));
    case type_float:
        return same_bits<float>(std::uint32_t(bits));
    case type_double:
        return same_bits<double>(bits);
    case type_rational:
        return ratio(word(0), word(1));
    case type_srational:
        return ratio(std::int32_t(word(0)), std::int32_t(word(1)));
    default:
        return std::numeric_limits<double>::quiet_NaN();
    }
}

bool holds_integers(std::uint16_t type)
{
    return type == type_byte || type == type_short || type == type_long
        || type == type_sbyte || type == type_sshort || type == type_slong
        || type == type_ifd || type == type_long8 || type == type_slong8
        || type == type_ifd8;
}

bool is_rational(std::uint16_t type)
{
    return type == type_rational || type == type_srational;
}

bool holds_bytes(std::uint16_t type)
{
    return type == type_byte || type == type_undefined;
}

} // namespace

TiffTags::TiffTags(const TiffReader& file, std::vector<const TiffIfd*> ifds)
    : m_file(file)
    , m_ifds(std::move(ifds))
{
}

std::vector<double> TiffTags::numbers(TiffTag tag, Bounds count) const
{
    const TiffEntry& entry = required(tag, count);
    const auto values = decoded(tag, entry);
    for (double value : values)
        if (!std::isfinite(value))
            fail(tag,
                 "holds a value that is no finite number (type "
                     + std::to_string(entry.type)
                     + "; a denominator of 0, infinity, NaN or text): the file is "
                       "damaged,"
                       " use another DNG of this camera");
    return values;
}

std::vector<std::int64_t> TiffTags::integers(TiffTag tag, Bounds count,
                                             Bounds value) const
{
    const TiffEntry& entry = required(tag, count);
    if (!holds_integers(entry.type))
        fail(tag,
             "has type " + std::to_string(entry.type)
                 + "; allowed: a type of integers, such as SHORT (3) or LONG (4)");
    std::vector<std::int64_t> result;
    for (double number : decoded(tag, entry)) {
        if (number < double(value.low) || number > double(value.high)) {
            std::string shown_number = std::to_string(number);
            shown_number.resize(shown_number.find('.'));
            fail(tag,
                 "is " + shown_number + "; allowed: " + shown(value)
                     + ": use another DNG of this camera");
        }
        result.push_back(std::int64_t(number));
    }
    return result;
}

std::int64_t TiffTags::integer_or(TiffTag tag, Bounds value,
                                  std::int64_t otherwise) const
{
    return has(tag) ? integers(tag, { 1, 1 }, value).front() : otherwise;
}

std::optional<double> TiffTags::finite(TiffTag tag, std::size_t index) const
{
    if (!has(tag))
        return std::nullopt;
    const auto values = decoded(tag, required(tag, { 1, 16 }));
    if (index >= values.size() || !std::isfinite(values[index]))
        return std::nullopt;
    return values[index];
}

std::optional<double> TiffTags::positive(TiffTag tag, std::size_t index) const
{
    const auto value = finite(tag, index);
    return value && *value > 0.0 ? value : std::nullopt;
}

std::optional<Fraction> TiffTags::fraction(TiffTag tag) const
{
    if (!has(tag))
        return std::nullopt;
    const TiffEntry& entry = required(tag, { 1, 16 });
    const bool rational = is_rational(entry.type);
    if (!rational && !holds_integers(entry.type))
        return std::nullopt;
    const auto values = raw_values(tag, entry);
    const std::size_t size = rational ? 4 : tiff_value_size(entry.type);
    const std::uint64_t numerator = m_file.number(values.data(), size);
    const std::uint64_t denominator
        = rational ? m_file.number(values.data() + size, size) : 1;
    // A negative number is, as its bits stand here, too large.
    constexpr std::uint64_t most = std::numeric_limits<std::int32_t>::max();
    if (numerator == 0 || denominator == 0 || numerator > most || denominator > most)
        return std::nullopt;
    return Fraction { std::int32_t(numerator), std::int32_t(denominator) };
}

double TiffTags::largest_denominator(TiffTag tag) const
{
    const TiffEntry& entry = required(tag, { 1, 16 });
    if (!is_rational(entry.type))
        return holds_integers(entry.type) ? 1.0
                                          : std::numeric_limits<double>::infinity();
    const auto values = raw_values(tag, entry);
    double largest = 1.0;
    for (std::size_t at = 4; at < values.size(); at += 8) {
        const auto bits = std::uint32_t(m_file.number(&values[at], 4));
        const bool negative = entry.type == type_srational && std::int32_t(bits) < 0;
        largest = std::max(largest, double(negative ? 0U - bits : bits));
    }
    return largest;
}

std::string TiffTags::text(TiffTag tag) const
{
    if (!has(tag))
        return {};
    const TiffEntry& entry = required(tag, text_length);
    if (entry.count == 0)
        return {};
    if (entry.type != type_ascii && !holds_bytes(entry.type))
        fail(tag, "has type " + std::to_string(entry.type) + "; allowed: ASCII (2)");
    const auto values = raw_values(tag, entry);
    return printable_text(
        { reinterpret_cast<const char*>(values.data()), values.size() });
}

std::vector<std::uint8_t> TiffTags::bytes(TiffTag tag, Bounds count) const
{
    const TiffEntry& entry = required(tag, count);
    if (!holds_bytes(entry.type))
        fail(tag,
             "has type " + std::to_string(entry.type)
                 + "; allowed: BYTE (1) or UNDEFINED (7)");
    return raw_values(tag, entry);
}

void TiffTags::fail(TiffTag tag, const std::string& what) const
{
    throw Error(m_file.name() + ": " + text_of(tag) + " " + what);
}

const TiffEntry* TiffTags::find(TiffTag tag) const
{
    for (const TiffIfd* ifd : m_ifds)
        for (const TiffEntry& entry : *ifd)
            if (entry.tag == tag.number)
                return &entry;
    return nullptr;
}

const TiffEntry& TiffTags::required(TiffTag tag, Bounds count) const
{
    const TiffEntry* const entry = find(tag);
    if (!entry)
        fail(tag, "is missing; it is required: use another DNG of this camera");
    if (entry->count < std::uint64_t(count.low)
        || entry->count > std::uint64_t(count.high))
        fail(tag,
             "has " + std::to_string(entry->count) + " values; allowed: " + shown(count)
                 + ": the file is damaged, use another DNG of this camera");
    return *entry;
}

std::vector<std::uint8_t> TiffTags::raw_values(TiffTag tag,
                                               const TiffEntry& entry) const
{
    auto values = m_file.values(entry);
    if (!values)
        fail(tag,
             "has " + std::to_string(entry.count) + " values of type "
                 + std::to_string(entry.type)
                 + " that the file does not hold: it is truncated or damaged");
    return std::move(*values);
}

std::vector<double> TiffTags::decoded(TiffTag tag, const TiffEntry& entry) const
{
    const auto raw = raw_values(tag, entry);
    const std::size_t size = tiff_value_size(entry.type);
    std::vector<double> result(entry.count);
    for (std::size_t i = 0; i < result.size(); ++i)
        result[i] = decoded_value(m_file, entry.type, &raw[i * size]);
    return result;
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Opcode lists: the gain maps of OpcodeList2, and the names of all the rest.
/// Source: DNG specification 1.7.1, "Opcode List Processing".
#include "reader/metadata_parts.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>

namespace cg2raw {
namespace {

/// Real lists have up to 80 kB; more would be a way to make us work for long.
constexpr Bounds list_bytes { 4, 4 << 20 };
/// Four of a Bayer sensor, 36 of an X-Trans.
constexpr std::size_t most_maps = 64;
/// That a note lists; the specification has 14.
constexpr std::size_t most_names = 16;
constexpr std::size_t opcode_header_bytes = 16, gain_map_bytes = 76;
constexpr std::uint32_t gain_map_id = 9, optional_flag = 1;
constexpr std::uint32_t most_pixels = 65535;
/// In heights or widths of the image; real ones are 0 to 1.
constexpr double farthest_point = 10.0;
constexpr double largest_gain = 1e6;

/// By their numbers, from 1.
constexpr const char* opcode_names[] = {
    "WarpRectilinear",  "WarpFisheye",      "FixVignetteRadial", "FixBadPixelsConstant",
    "FixBadPixelsList", "TrimBounds",       "MapTable",          "MapPolynomial",
    "GainMap",          "DeltaPerRow",      "DeltaPerColumn",    "ScalePerRow",
    "ScalePerColumn",   "WarpRectilinear2",
};

std::string opcode_name(std::uint32_t id)
{
    const bool known = id >= 1 && id <= std::size(opcode_names);
    return (known ? opcode_names[id - 1] : "opcode")
        + (" (" + std::to_string(id) + ")");
}

/// Reads on through the bytes of a list, big-endian whatever the file is; its errors
/// say where.
class OpcodeBytes {
public:
    OpcodeBytes(const TiffTags& raw, TiffTag list)
        : m_raw(raw)
        , m_list(list)
        , m_bytes(raw.bytes(list, list_bytes))
    {
    }

    /// What errors call the bytes from here on.
    void enter(const std::string& where) { m_where = where; }
    std::size_t left() const { return m_bytes.size() - m_at; }
    void skip(std::size_t count) { m_at += count; }

    std::uint32_t word() { return std::uint32_t(bits(4)); }
    float real32()
    {
        const std::uint32_t word = this->word();
        float value = 0.0f;
        std::memcpy(&value, &word, sizeof value);
        return value;
    }
    double real64()
    {
        const std::uint64_t word = bits(8);
        double value = 0.0;
        std::memcpy(&value, &word, sizeof value);
        return value;
    }
    std::uint32_t word(const char* field, std::uint32_t low, std::uint32_t high)
    {
        const std::uint32_t value = word();
        if (value < low || value > high)
            fail(std::string(field) + " " + std::to_string(value) + " must be "
                 + std::to_string(low) + " to " + std::to_string(high));
        return value;
    }

    [[noreturn]] void fail(const std::string& what) const
    {
        m_raw.fail(m_list,
                   m_where + what
                       + ": the file is damaged, use another DNG of this camera");
    }

private:
    std::uint64_t bits(std::size_t count)
    {
        if (left() < count)
            fail("ends before its last field");
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < count; ++i)
            value = value << 8 | m_bytes[m_at++];
        return value;
    }

    const TiffTags& m_raw;
    TiffTag m_list;
    std::vector<std::uint8_t> m_bytes;
    std::size_t m_at = 0;
    std::string m_where;
};

struct Opcode {
    std::uint32_t id, flags;
    std::size_t size;
};

/// Calls @p read of each opcode with the bytes at its parameters.
template <class Read> void each_opcode(OpcodeBytes& bytes, const Read& read)
{
    const std::uint32_t count = bytes.word();
    if (count > bytes.left() / opcode_header_bytes)
        bytes.fail("claims " + std::to_string(count) + " opcodes, but has room for "
                   + std::to_string(bytes.left() / opcode_header_bytes));
    for (std::uint32_t i = 1; i <= count; ++i) {
        const std::string place
            = "opcode " + std::to_string(i) + " of " + std::to_string(count);
        bytes.enter(place + " ");
        Opcode opcode {};
        opcode.id = bytes.word();
        bytes.enter(place + ", " + opcode_name(opcode.id) + ": ");
        bytes.word(); // the version that brought it: its layout does not depend on it
        opcode.flags = bytes.word();
        opcode.size = bytes.word();
        if (opcode.size > bytes.left())
            bytes.fail("claims " + std::to_string(opcode.size) + " bytes where "
                       + std::to_string(bytes.left()) + " are left");
        const std::size_t left_behind = bytes.left() - opcode.size;
        read(opcode);
        bytes.skip(bytes.left() - left_behind);
    }
}

std::vector<int> covered_sites(const GainMapAt& map, const CfaPattern& cfa)
{
    std::vector<int> sites;
    for (int i = 0; i < cfa.height; ++i)
        for (int j = 0; j < cfa.width; ++j) {
            const int row = map.top + i * map.row_pitch;
            const int col = map.left + j * map.col_pitch;
            if (row < map.bottom && col < map.right)
                sites.push_back(row % cfa.height * cfa.width + col % cfa.width);
        }
    std::sort(sites.begin(), sites.end());
    sites.erase(std::unique(sites.begin(), sites.end()), sites.end());
    return sites;
}

/// The area may reach beyond the image; what is outside is nothing.
void read_area(OpcodeBytes& bytes, Size image, GainMapAt& map)
{
    const auto word = [&] { return int(std::min(bytes.word(), most_pixels)); };
    map.top = word();
    map.left = word();
    map.bottom = std::min(word(), image.height);
    map.right = std::min(word(), image.width);
    if (map.top >= map.bottom || map.left >= map.right)
        bytes.fail("its area covers no pixel of the " + std::to_string(image.width)
                   + " x " + std::to_string(image.height) + " active area");
}

double read_distance(OpcodeBytes& bytes, const char* field, double low)
{
    const double value = bytes.real64();
    if (!(value >= low && value <= farthest_point))
        bytes.fail(std::string(field) + " is not within its bounds, "
                   + (low < 0.0 ? "-10 to 10" : "above 0 to 10"));
    return value;
}

/// One point has no neighbour: whatever its file says, the distance is that of the
/// image.
double read_spacing(OpcodeBytes& bytes, const char* field, int points)
{
    constexpr double above_zero = 1e-6;
    if (points > 1)
        return read_distance(bytes, field, above_zero);
    bytes.real64();
    return 1.0;
}

/// Of the first plane only: a mosaic has no more. @p available gains follow.
void read_gains(OpcodeBytes& bytes, std::size_t available, std::size_t planes,
                GainMap& map)
{
    const std::size_t points = std::size_t(map.rows) * std::size_t(map.cols);
    if (points * planes != available)
        bytes.fail("its " + std::to_string(map.rows) + " x " + std::to_string(map.cols)
                   + " points of " + std::to_string(planes) + " planes need "
                   + std::to_string(points * planes) + " gains, but it has "
                   + std::to_string(available));
    map.gains.reserve(points);
    for (std::size_t i = 0; i < points; ++i) {
        const float gain = bytes.real32();
        if (!(gain > 0.0F && double(gain) <= largest_gain))
            bytes.fail("gain " + std::to_string(i)
                       + " is not within its bounds, above 0 to 1000000");
        map.gains.push_back(gain);
        bytes.skip(4 * (planes - 1));
    }
}

/// Appends the map, unless it is one for a plane that a mosaic does not have.
void read_gain_map(OpcodeBytes& bytes, const Opcode& opcode, DngMetadata& metadata)
{
    if (opcode.size < gain_map_bytes || (opcode.size - gain_map_bytes) % 4 != 0)
        bytes.fail("has " + std::to_string(opcode.size)
                   + " bytes; a map has 76, and 4 for each gain");
    if (metadata.gain_maps.size() == most_maps)
        bytes.fail("is one map too many: up to 64 are read");
    GainMapAt map {};
    read_area(bytes, metadata.active_area, map);
    const std::uint32_t first_plane = bytes.word();
    bytes.word("Planes", 1, most_pixels);
    map.row_pitch = int(bytes.word("RowPitch", 1, most_pixels));
    map.col_pitch = int(bytes.word("ColPitch", 1, most_pixels));
    map.map.rows = int(bytes.word("MapPointsV", 1, most_pixels));
    map.map.cols = int(bytes.word("MapPointsH", 1, most_pixels));
    map.spacing_v = read_spacing(bytes, "MapSpacingV", map.map.rows);
    map.spacing_h = read_spacing(bytes, "MapSpacingH", map.map.cols);
    map.origin_v = read_distance(bytes, "MapOriginV", -farthest_point);
    map.origin_h = read_distance(bytes, "MapOriginH", -farthest_point);
    const std::uint32_t planes = bytes.word("MapPlanes", 1, most_pixels);
    read_gains(bytes, (opcode.size - gain_map_bytes) / 4, planes, map.map);
    map.sites = covered_sites(map, metadata.cfa);
    if (first_plane == 0)
        metadata.gain_maps.push_back(std::move(map));
}

/// One note for a list's opcodes that are not looked into.
void add_note(TiffTag list, const std::vector<std::string>& names,
              DngMetadata& metadata)
{
    if (names.empty())
        return;
    std::string text;
    for (const std::string& name : names)
        text += (text.empty() ? "" : ", ") + name;
    metadata.notes.push_back(std::string(list.name) + " (" + std::to_string(list.number)
                             + ") has " + text
                             + ": what raw converters correct by it is not simulated");
}

void read_list(const TiffTags& raw, TiffTag list, bool with_gain_maps,
               DngMetadata& metadata)
{
    OpcodeBytes bytes(raw, list);
    std::vector<std::string> others;
    each_opcode(bytes, [&](const Opcode& opcode) {
        if (with_gain_maps && opcode.id == gain_map_id)
            return read_gain_map(bytes, opcode, metadata);
        const std::string name = opcode_name(opcode.id)
            + (opcode.flags & optional_flag ? ", optional" : "");
        if (others.size() < most_names
            && std::find(others.begin(), others.end(), name) == others.end())
            others.push_back(name);
    });
    add_note(list, others, metadata);
}

} // namespace

/// List 1 is applied to values as stored, list 3 after demosaicking: neither has a
/// place in a mosaic that is made, so they are named, and damage in them is no
/// obstacle.
void read_dng_opcodes(const TiffTags& raw, DngMetadata& metadata)
{
    if (raw.has(tag::opcode_list_2))
        read_list(raw, tag::opcode_list_2, true, metadata);
    for (TiffTag list : { tag::opcode_list_1, tag::opcode_list_3 })
        try {
            if (raw.has(list))
                read_list(raw, list, false, metadata);
        } catch (const Error&) {
            metadata.notes.push_back(std::string(list.name) + " ("
                                     + std::to_string(list.number)
                                     + ") is damaged or too long; it is not needed");
        }
}

} // namespace cg2raw

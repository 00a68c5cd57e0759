// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "writer/tags.h"

#include "cg2raw/types.h"

#include <algorithm>
#include <cstring>

namespace cg2raw {

namespace {

/// Source: DNG specification 1.4, chapter 6, "GainMap".
constexpr std::uint32_t gain_map_id = 9;
constexpr std::uint32_t since_dng_1_3 = 0x01030000;
/// A reader that does not know it may skip it.
constexpr std::uint32_t optional_flag = 1;
constexpr std::uint32_t parameter_bytes = 76; // before the gains

/// Opcode lists are big-endian whatever the file is.
class BigEndian {
public:
    void put(std::uint32_t value)
    {
        for (int shift = 24; shift >= 0; shift -= 8)
            m_bytes.push_back(std::uint8_t(value >> shift));
    }
    void put(float value)
    {
        std::uint32_t word = 0;
        std::memcpy(&word, &value, sizeof word);
        put(word);
    }
    void put(double value)
    {
        std::uint64_t word = 0;
        std::memcpy(&word, &value, sizeof word);
        put(std::uint32_t(word >> 32));
        put(std::uint32_t(word));
    }
    Bytes take() { return std::move(m_bytes); }

private:
    Bytes m_bytes;
};

/// The map for every @p pitch-th pixel each way, from @p site on.
void put_opcode(BigEndian& out, const GainMap& map, Size size, Size pitch, Site site)
{
    out.put(gain_map_id);
    out.put(since_dng_1_3);
    out.put(optional_flag);
    out.put(std::uint32_t(parameter_bytes + 4 * map.gains.size()));
    for (const int edge : { site.row, site.col, size.height, size.width })
        out.put(std::uint32_t(edge)); // top, left, bottom, right
    out.put(std::uint32_t(0)); // first plane
    out.put(std::uint32_t(1)); // planes
    out.put(std::uint32_t(pitch.height)); // of rows
    out.put(std::uint32_t(pitch.width)); // of columns
    out.put(std::uint32_t(map.rows));
    out.put(std::uint32_t(map.cols));
    out.put(1.0 / (map.rows - 1)); // spacing; the map spans the active area, 0 to 1
    out.put(1.0 / (map.cols - 1));
    out.put(0.0); // origin
    out.put(0.0);
    out.put(std::uint32_t(1)); // planes of the map
    for (const float gain : map.gains)
        out.put(gain);
}

} // namespace

/// A map for each pixel of 2 x 2, four in all, even if they are the same: one for all
/// pixels is as legal, but darktable applies gain maps only if they are four of pitch
/// 2, and does so whatever the CFA's repeat. Only where colours differ on a larger
/// repeat is there a map for each of its sites. A monochrome plane has one for all.
Bytes gain_map_opcodes(const std::array<GainMap, 3>& maps, const CfaPattern& cfa,
                       Size size)
{
    for (const GainMap& map : maps)
        if (map.rows < 2 || map.cols < 2
            || map.gains.size() != std::size_t(map.rows) * std::size_t(map.cols))
            throw Error("DNG: shading needs maps of at least 2 x 2 gains, all given");
    const bool alike = maps[0].gains == maps[1].gains && maps[2].gains == maps[1].gains;
    const bool in_fours = alike && !cfa.is_mono();
    const Size pitch = in_fours ? Size { 2, 2 } : Size { cfa.width, cfa.height };
    const int rows = std::min(pitch.height, size.height);
    const int cols = std::min(pitch.width, size.width);
    BigEndian out;
    out.put(std::uint32_t(rows * cols)); // opcodes
    for (int row = 0; row < rows; ++row)
        for (int col = 0; col < cols; ++col) {
            const Site site { row, col };
            put_opcode(out, maps[std::size_t(cfa.color(site))], size, pitch, site);
        }
    return out.take();
}

} // namespace cg2raw

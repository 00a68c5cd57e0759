// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Opcode lists for tests of the reader, byte by byte from the specification.
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <vector>

namespace cg2raw::test {

/// An opcode: its number, flags and parameters.
struct TestOpcode {
    std::uint32_t id, flags;
    std::vector<std::uint64_t> parameters; ///< bytes
};

inline void append(std::vector<std::uint64_t>& bytes, std::uint64_t bits, int count)
{
    for (int i = count - 1; i >= 0; --i)
        bytes.push_back(bits >> 8 * i & 0xFF);
}

inline std::vector<std::uint64_t> opcode_list(const std::vector<TestOpcode>& opcodes)
{
    std::vector<std::uint64_t> bytes;
    append(bytes, opcodes.size(), 4);
    for (const TestOpcode& opcode : opcodes) {
        append(bytes, opcode.id, 4);
        append(bytes, 0x01030000, 4);
        append(bytes, opcode.flags, 4);
        append(bytes, opcode.parameters.size(), 4);
        bytes.insert(bytes.end(), opcode.parameters.begin(), opcode.parameters.end());
    }
    return bytes;
}

/// A GainMap for all pixels of an 8 x 6 image, its points from edge to edge.
struct OpcodeBuilder {
    std::uint32_t points_v, points_h;
    /// Of a place, 0 to 1 downwards and to the right.
    std::function<double(double, double)> gain = [](double, double) { return 1.0; };
    std::vector<std::uint32_t> area { 0, 0, 6, 8 };
    std::uint32_t plane = 0, planes = 1;
    std::uint32_t row_pitch = 1, col_pitch = 1;
    double spacing_v = 1.0 / (points_v - 1), spacing_h = 1.0 / (points_h - 1);
    double origin_v = 0.0, origin_h = 0.0;
    std::uint32_t map_planes = 1;

    TestOpcode gain_map() const
    {
        TestOpcode opcode { 9, 1, {} };
        const auto word
            = [&](std::uint32_t value) { append(opcode.parameters, value, 4); };
        const auto real = [&](double value) {
            std::uint64_t bits = 0;
            std::memcpy(&bits, &value, sizeof bits);
            append(opcode.parameters, bits, 8);
        };
        for (std::uint32_t edge : area)
            word(edge);
        for (std::uint32_t value :
             { plane, planes, row_pitch, col_pitch, points_v, points_h })
            word(value);
        for (double value : { spacing_v, spacing_h, origin_v, origin_h })
            real(value);
        word(map_planes);
        for (std::uint32_t row = 0; row < points_v; ++row)
            for (std::uint32_t col = 0; col < points_h; ++col)
                for (std::uint32_t i = 0; i < map_planes; ++i) {
                    const float value = float(
                        gain(origin_v + row * spacing_v, origin_h + col * spacing_h)
                        + i);
                    std::uint32_t bits = 0;
                    std::memcpy(&bits, &value, sizeof bits);
                    word(bits);
                }
        return opcode;
    }
};

} // namespace cg2raw::test

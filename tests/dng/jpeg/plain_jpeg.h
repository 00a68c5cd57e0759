// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Lossless JPEG of any predictor, number of components and precision, as T.81
/// words it, a bit at a time; its one Huffman table has a code of five bits per size.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

namespace cg2raw::test {

struct PlainJpeg {
    int lines, columns, components, precision, predictor;
    std::vector<std::uint16_t> samples; ///< lines x columns x components

    std::vector<std::uint8_t> encoded() const
    {
        std::vector<std::uint8_t> jpeg { 0xff, 0xd8, 0xff, 0xc4, 0, 36, 0 };
        for (int length = 1; length <= 16; ++length)
            jpeg.push_back(length == 5 ? 17 : 0);
        for (int size = 0; size <= 16; ++size)
            jpeg.push_back(std::uint8_t(size));
        const auto word = [&](int value) {
            jpeg.push_back(std::uint8_t(value >> 8));
            jpeg.push_back(std::uint8_t(value));
        };
        word(0xffc3);
        word(8 + 3 * components);
        jpeg.push_back(std::uint8_t(precision));
        word(lines);
        word(columns);
        jpeg.push_back(std::uint8_t(components));
        for (int c = 0; c < components; ++c)
            jpeg.insert(jpeg.end(), { std::uint8_t(c), 0x11, 0 });
        word(0xffda);
        word(6 + 2 * components);
        jpeg.push_back(std::uint8_t(components));
        for (int c = 0; c < components; ++c)
            jpeg.insert(jpeg.end(), { std::uint8_t(c), 0 });
        jpeg.insert(jpeg.end(), { std::uint8_t(predictor), 0, 0 });
        append(jpeg, bits());
        word(0xffd9);
        return jpeg;
    }

private:
    int prediction(int line, int column, int c) const
    {
        const auto at = [&](int l, int x) {
            return int(samples[std::size_t((l * columns + x) * components + c)]);
        };
        if (line == 0 && column == 0)
            return 1 << (precision - 1);
        if (line == 0)
            return at(0, column - 1);
        if (column == 0)
            return at(line - 1, 0);
        const int a = at(line, column - 1), b = at(line - 1, column);
        const int corner = at(line - 1, column - 1);
        const int predictions[] = { a,
                                    b,
                                    corner,
                                    a + b - corner,
                                    a + ((b - corner) >> 1),
                                    b + ((a - corner) >> 1),
                                    (a + b) >> 1 };
        return predictions[predictor - 1];
    }

    std::string bits() const
    {
        std::string bits;
        const auto put = [&](unsigned value, int count) {
            for (int i = count - 1; i >= 0; --i)
                bits += (value >> i & 1) != 0 ? '1' : '0';
        };
        std::size_t i = 0;
        for (int line = 0; line < lines; ++line)
            for (int column = 0; column < columns; ++column)
                for (int c = 0; c < components; ++c) {
                    int difference = std::int16_t(
                        std::uint16_t(samples[i++] - prediction(line, column, c)));
                    int size = 0;
                    while (std::abs(difference) >> size != 0)
                        ++size;
                    put(unsigned(size), 5);
                    if (difference < 0)
                        --difference;
                    if (size < 16)
                        put(unsigned(difference) & ((1U << size) - 1), size);
                }
        while (bits.size() % 8 != 0)
            bits += '1';
        return bits;
    }

    static void append(std::vector<std::uint8_t>& jpeg, const std::string& bits)
    {
        for (std::size_t i = 0; i < bits.size(); i += 8) {
            jpeg.push_back(std::uint8_t(std::stoi(bits.substr(i, 8), nullptr, 2)));
            if (jpeg.back() == 0xff)
                jpeg.push_back(0);
        }
    }
};

} // namespace cg2raw::test

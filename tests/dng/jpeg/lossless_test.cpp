// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "jpeg/lossless.h"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <map>
#include <stdexcept>

namespace cg2raw {
namespace {

/// A decoder as T.81 words it, one bit at a time; for SOF3, predictor 1, one table.
class Decoder {
public:
    explicit Decoder(const std::vector<std::uint8_t>& jpeg)
        : m_jpeg(jpeg)
    {
        expect(0xffd8);
        read_table();
        read_frame();
        read_scan();
    }

    /// (height, columns x components), row major.
    std::vector<std::uint16_t> decode()
    {
        const std::size_t row = std::size_t(columns) * 2;
        std::vector<std::uint16_t> out(row * std::size_t(height));
        for (std::size_t i = 0; i < out.size(); ++i) {
            const int left = i % row >= 2 ? out[i - 2]
                : i >= row                ? out[i - row]
                                          : 1 << (precision - 1);
            out[i] = std::uint16_t(left + difference());
        }
        while (m_bit > 0) // what is left of the last byte is ones
            EXPECT_EQ(bit(), 1U);
        expect(0xffd9);
        EXPECT_EQ(m_at, m_jpeg.size());
        return out;
    }

    int precision = 0, height = 0, columns = 0;

private:
    unsigned byte() { return m_jpeg.at(m_at++); }
    unsigned word()
    {
        const unsigned high = byte();
        return high << 8 | byte();
    }
    void expect(unsigned value)
    {
        if (word() != value)
            throw std::runtime_error("unexpected bytes before " + std::to_string(m_at));
    }
    void read_table()
    {
        expect(0xffc4);
        const unsigned length = word();
        EXPECT_EQ(byte(), 0U);
        std::array<unsigned, 16> counts;
        unsigned total = 0;
        for (unsigned& count : counts)
            total += count = byte();
        EXPECT_EQ(length, 19 + total);
        unsigned code = 0;
        for (unsigned bits = 1; bits <= 16; ++bits, code <<= 1)
            for (unsigned i = 0; i < counts[bits - 1]; ++i)
                m_table[{ bits, code++ }] = byte();
    }
    void read_frame()
    {
        expect(0xffc3);
        EXPECT_EQ(word(), 14U);
        precision = int(byte());
        height = int(word());
        columns = int(word());
        EXPECT_EQ(byte(), 2U);
        for (unsigned c = 0; c < 2; ++c) {
            EXPECT_EQ(byte(), c);
            EXPECT_EQ(word(), 0x1100U);
        }
    }
    void read_scan()
    {
        expect(0xffda);
        EXPECT_EQ(word(), 10U);
        EXPECT_EQ(byte(), 2U);
        EXPECT_EQ(word(), 0x0000U);
        EXPECT_EQ(word(), 0x0100U);
        EXPECT_EQ(byte(), 1U); // predictor
        EXPECT_EQ(word(), 0U);
    }
    unsigned bit()
    {
        const unsigned value = m_jpeg.at(m_at) >> (7 - m_bit) & 1;
        if (++m_bit == 8) {
            m_bit = 0;
            if (m_jpeg[m_at++] == 0xff && byte() != 0)
                throw std::runtime_error("a marker within the codes");
        }
        return value;
    }
    int difference()
    {
        unsigned code = 0, length = 0;
        for (;;) {
            code = code << 1 | bit();
            const auto found = m_table.find({ ++length, code });
            if (found == m_table.end()) {
                if (length == 16)
                    throw std::runtime_error("no such code");
                continue;
            }
            const unsigned size = found->second;
            if (size == 16)
                return 32768;
            unsigned own = 0;
            for (unsigned i = 0; i < size; ++i)
                own = own << 1 | bit();
            return size > 0 && own < 1U << (size - 1) ? int(own) - (1 << size) + 1
                                                      : int(own);
        }
    }

    const std::vector<std::uint8_t>& m_jpeg;
    std::map<std::pair<unsigned, unsigned>, unsigned> m_table; ///< length, code -> size
    std::size_t m_at = 0;
    unsigned m_bit = 0;
};

using Image = std::function<unsigned(int row, int col)>;

/// Encodes a @p covered image in a @p tile, decodes it, and compares what is covered.
std::vector<std::uint16_t> round_trip(const Image& image, Size covered, Size tile,
                                      int bits, int* precision = nullptr)
{
    const int pitch = covered.width + 3; // the rest of a wider image, never to be read
    std::vector<std::uint16_t> dn(std::size_t(pitch) * std::size_t(covered.height),
                                  54321);
    for (int row = 0; row < covered.height; ++row)
        for (int col = 0; col < covered.width; ++col)
            dn[std::size_t(row * pitch + col)] = std::uint16_t(image(row, col));
    JpegScratch scratch;
    std::vector<std::uint8_t> jpeg;
    encode_lossless_jpeg({ dn.data(), covered.width, covered.height, pitch }, tile,
                         { 2, 2 }, bits, Prediction::left, scratch, jpeg);
    Decoder decoder(jpeg);
    EXPECT_EQ(decoder.height, tile.height);
    EXPECT_EQ(decoder.columns, tile.width / 2);
    if (precision)
        *precision = decoder.precision;
    std::vector<std::uint16_t> out = decoder.decode();
    for (int row = 0; row < covered.height; ++row)
        for (int col = 0; col < covered.width; ++col)
            EXPECT_EQ(out[std::size_t(row * tile.width + col)],
                      dn[std::size_t(row * pitch + col)])
                << row << ", " << col;
    return out;
}

struct Planted {
    const char* name;
    int bits;
    Image image;
};

unsigned noise(int row, int col)
{
    unsigned state = unsigned(row) * 2654435761U ^ unsigned(col) * 40503U;
    state = (state ^ state >> 13) * 1274126177U;
    return state ^ state >> 16;
}

class LosslessJpeg : public ::testing::TestWithParam<Planted> { };

TEST_P(LosslessJpeg, GivesEveryValueBack)
{
    const Planted& planted = GetParam();
    for (const Size size : { Size { 64, 48 }, Size { 2, 16 }, Size { 16, 1 } })
        round_trip(planted.image, size, size, planted.bits);
}

INSTANTIATE_TEST_SUITE_P(
    Images, LosslessJpeg,
    ::testing::Values(
        Planted { "zero", 14, [](int, int) { return 0U; } },
        Planted { "constant", 10, [](int, int) { return 1023U; } },
        Planted { "random16", 16, [](int r, int c) { return noise(r, c) & 0xffffU; } },
        Planted { "random9", 9, [](int r, int c) { return noise(r, c) & 0x1ffU; } },
        Planted { "extremes", 16,
                  [](int r, int c) { return noise(r, c) & 1U ? 0xffffU : 0U; } },
        // Differences of 32768, the only ones of size 16.
        Planted {
            "half_range", 16,
            [](int r, int c) { return (unsigned(c) / 2 + unsigned(r)) % 2 * 32768U; } },
        // Each size from 0 to 16 in turn, up and down.
        Planted { "all_sizes", 16,
                  [](int r, int c) {
                      return unsigned(c) / 2 % 2 == 0
                          ? 0U
                          : (1U << (unsigned(c + r) % 17)) & 0xffffU;
                  } },
        // Long runs of one bits: stuffing.
        Planted { "stuffing", 16,
                  [](int r, int c) {
                      return (unsigned(r * 64 + c) / 2 * 32767U) & 0xffffU;
                  } },
        Planted { "gradient", 12,
                  [](int r, int c) { return unsigned(r * 17 + c * 31) & 0xfffU; } }),
    [](const auto& info) { return info.param.name; });

TEST(LosslessJpeg, PaddingKeepsThePhase)
{
    // Four levels by site: beyond the image, too, each site keeps its own.
    const Image sites
        = [](int r, int c) { return unsigned(100 + 40 * (r % 2) + 10 * (c % 2)); };
    for (const Size covered : { Size { 5, 3 }, Size { 2, 2 }, Size { 31, 16 } }) {
        const std::vector<std::uint16_t> out
            = round_trip(sites, covered, { 32, 16 }, 9);
        for (int row = 0; row < 16; ++row)
            for (int col = 0; col < 32; ++col)
                EXPECT_EQ(out[std::size_t(row * 32 + col)], sites(row, col));
    }
    round_trip(sites, { 1, 1 }, { 16, 16 }, 9);
}

TEST(LosslessJpeg, PrecisionIsTheRangeUnlessAValueExceedsIt)
{
    int precision = 0;
    round_trip([](int, int c) { return unsigned(c); }, { 16, 16 }, { 16, 16 }, 10,
               &precision);
    EXPECT_EQ(precision, 10);
    round_trip([](int, int c) { return unsigned(c == 3 ? 4096 : c); }, { 16, 16 },
               { 16, 16 }, 10, &precision);
    EXPECT_EQ(precision, 13);
}

} // namespace
} // namespace cg2raw

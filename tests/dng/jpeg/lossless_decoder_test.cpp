// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "jpeg/lossless_decoder.h"

#include "jpeg/lossless.h"
#include "jpeg/plain_jpeg.h"

#include <gtest/gtest.h>

#include <string>
#include <tuple>

namespace cg2raw {
namespace {

using test::PlainJpeg;
using Jpeg = std::vector<std::uint8_t>;

/// Values all over @p bits, and runs of equal ones.
std::vector<std::uint16_t> values(std::size_t count, int bits)
{
    std::vector<std::uint16_t> result(count);
    std::uint32_t state = 7;
    for (std::uint16_t& value : result) {
        state = state * 1664525U + 1013904223U; // Numerical Recipes' generator
        value = std::uint16_t((state >> 9) & ((1U << bits) - 1));
        if ((state >> 30) == 0 && &value != result.data())
            value = (&value)[-1];
    }
    return result;
}

std::vector<std::uint16_t> decoded(const Jpeg& jpeg, std::size_t count)
{
    std::vector<std::uint16_t> out(count);
    decode_lossless_jpeg(jpeg, out.data(), count);
    return out;
}

std::string error_of(const Jpeg& jpeg, std::size_t count)
{
    try {
        decoded(jpeg, count);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

/// 3 lines of 5 columns of 2 components.
PlainJpeg small() { return { 3, 5, 2, 12, 1, values(30, 12) }; }

class EveryKind : public testing::TestWithParam<std::tuple<int, int, int>> { };

TEST_P(EveryKind, ComesBack)
{
    const auto [predictor, components, precision] = GetParam();
    const PlainJpeg jpeg {
        7,         9,         components,
        precision, predictor, values(std::size_t(63 * components), precision)
    };
    EXPECT_EQ(decoded(jpeg.encoded(), jpeg.samples.size()), jpeg.samples);
}

INSTANTIATE_TEST_SUITE_P(LosslessDecoder, EveryKind,
                         testing::Combine(testing::Range(1, 8), testing::Range(1, 5),
                                          testing::Values(2, 8, 12, 14, 16)));

TEST(LosslessDecoder, ReadsWhatTheEncoderWrites)
{
    for (const int bits : { 9, 12, 16 })
        for (const Size repeat : { Size { 2, 2 }, Size { 6, 6 }, Size { 1, 1 } }) {
            const Size tile { 112, 48 };
            const auto dn = values(std::size_t(tile.width * tile.height), bits);
            JpegScratch scratch;
            Jpeg jpeg;
            for (const Prediction prediction : { Prediction::left, Prediction::best }) {
                encode_lossless_jpeg({ dn.data(), tile.width, tile.height, tile.width },
                                     tile, repeat, bits, prediction, scratch, jpeg);
                EXPECT_EQ(decoded(jpeg, dn.size()), dn);
            }
        }
}

TEST(LosslessDecoder, RefusesAnotherNumberOfSamples)
{
    EXPECT_EQ(error_of(small().encoded(), 31),
              "has 3 lines of 5 x 2 samples, not 31 in all");
}

TEST(LosslessDecoder, RefusesWhatEndsEarly)
{
    const Jpeg whole = small().encoded();
    for (std::size_t size = 0; size + 2 < whole.size(); ++size) // EOI may be missing
        EXPECT_NE(
            error_of(Jpeg(whole.begin(), whole.begin() + std::ptrdiff_t(size)), 30), "")
            << size;
}

TEST(LosslessDecoder, NamesWhatItDoesNotRead)
{
    const auto changed = [](std::size_t at, int value) {
        Jpeg jpeg = small().encoded();
        jpeg.at(at) = std::uint8_t(value);
        return error_of(jpeg, 30);
    };
    constexpr std::size_t dht = 2, sof = dht + 2 + 36, sos = sof + 2 + 14;
    EXPECT_EQ(changed(0, 0), "does not start as a JPEG does");
    EXPECT_EQ(changed(dht + 4, 4),
              "has a Huffman table that lossless JPEG does not know");
    EXPECT_EQ(changed(dht + 22, 17),
              "has a Huffman table of sizes up to 17 bits; those of differences are 0 "
              "to 16");
    EXPECT_EQ(changed(sof + 1, 0xc0),
              "is of process SOF0; only lossless JPEG, SOF3, keeps a mosaic");
    EXPECT_EQ(changed(sof + 4, 17), "has 17 bits a sample; allowed: 2 to 16");
    EXPECT_EQ(changed(sof + 9, 5), "has 5 components; allowed: 1 to 4");
    EXPECT_EQ(changed(sof + 11, 0x21), "has components of different sizes");
    EXPECT_EQ(changed(sos + 4, 1),
              "has several scans; a DNG's has all components in one");
    EXPECT_EQ(changed(sos + 6, 0x10),
              "has a scan of a component or a table that it lacks");
    EXPECT_EQ(changed(sos + 9, 8), "has predictor 8; allowed: 1 to 7");
    EXPECT_EQ(changed(sos + 11, 1), "has a point transform, which drops bits");
}

TEST(LosslessDecoder, RefusesMoreCodesThanFit)
{
    Jpeg jpeg = small().encoded();
    constexpr std::size_t counts = 7;
    std::swap(jpeg.at(counts + 3), jpeg.at(counts + 4)); // 17 codes of four bits
    EXPECT_EQ(error_of(jpeg, 30), "has a Huffman table of more codes than fit");
}

TEST(LosslessDecoder, SurvivesEveryChangedByte)
{
    const Jpeg whole = small().encoded();
    std::size_t refused = 0;
    for (std::size_t at = 0; at < whole.size(); ++at)
        for (const int change : { 0x01, 0x80, 0xff }) {
            Jpeg jpeg = whole;
            jpeg[at] = std::uint8_t(jpeg[at] ^ change);
            refused += error_of(jpeg, 30).empty() ? 0 : 1;
        }
    EXPECT_GT(refused, whole.size() / 2);
}

} // namespace
} // namespace cg2raw

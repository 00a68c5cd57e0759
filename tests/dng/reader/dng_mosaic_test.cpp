// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "cg2raw/dng_mosaic.h"

#include "jpeg/plain_jpeg.h"
#include "pixel_builder.h"
#include "writer_fixture.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <tuple>

namespace cg2raw::test {
namespace {

using Words = std::vector<std::uint16_t>;

constexpr Size size { 8, 6 }; // of raw_tags()

Words words(std::size_t count, int bits)
{
    Words result(count);
    std::uint32_t state = 3;
    for (std::uint16_t& word : result) {
        state = state * 1664525U + 1013904223U; // Numerical Recipes' generator
        word = std::uint16_t((state >> 9) & ((1U << bits) - 1));
    }
    return result;
}

/// Rows of a mosaic of that size.
Words rows_of(const Words& dn, int first, int rows)
{
    const auto begin = dn.begin() + std::ptrdiff_t(first) * size.width;
    return { begin, begin + std::ptrdiff_t(rows) * size.width };
}

Words read_all(const std::string& file)
{
    std::istringstream stream(file);
    DngMosaic mosaic(stream, "test.dng");
    const Size all = mosaic.storage().size;
    Words dn(std::size_t(all.width * all.height));
    mosaic.read_rows(0, { dn.data(), all.width, all.height, all.width });
    return dn;
}

std::string error_of(const std::string& file)
{
    try {
        read_all(file);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

/// Part of @p dn that a tile shows; beyond the image there are zeros.
Words tile_of(const Words& dn, int left, int top, Size tile)
{
    Words part;
    for (int row = top; row < top + tile.height; ++row)
        for (int col = left; col < left + tile.width; ++col)
            part.push_back(row < size.height && col < size.width
                               ? dn[std::size_t(row * size.width + col)]
                               : std::uint16_t(0));
    return part;
}

class EveryWord : public ::testing::TestWithParam<std::tuple<int, bool>> { };

TEST_P(EveryWord, OfStripsComesBack)
{
    const int bits = std::get<0>(GetParam());
    const bool big_endian = std::get<1>(GetParam());
    const Words dn = words(48, bits);
    const auto strip = [&](int first, int rows) {
        return packed(rows_of(dn, first, rows), size.width, bits, big_endian);
    };
    PixelDng dng { bits, { strip(0, 4), strip(4, 2) } };
    dng.ifd.longs(278, { 4 }); // RowsPerStrip
    EXPECT_EQ(read_all(dng.file(big_endian)), dn);
}

TEST_P(EveryWord, OfTilesComesBack)
{
    const auto [bits, big_endian] = GetParam();
    const Words dn = words(48, bits);
    constexpr Size tile { 5, 4 };
    std::vector<std::string> chunks;
    for (const int top : { 0, 4 })
        for (const int left : { 0, 5 })
            chunks.push_back(
                packed(tile_of(dn, left, top, tile), tile.width, bits, big_endian));
    PixelDng dng { bits, chunks, tile };
    EXPECT_EQ(read_all(dng.file(big_endian)), dn);
}

INSTANTIATE_TEST_SUITE_P(DngMosaic, EveryWord,
                         ::testing::Combine(::testing::Values(8, 9, 10, 12, 14, 16),
                                            ::testing::Bool()));

PixelDng jpeg_dng(const PlainJpeg& jpeg)
{
    const auto bytes = jpeg.encoded();
    PixelDng dng { 16, { std::string(bytes.begin(), bytes.end()) } };
    dng.ifd.shorts(259, { 7 });
    return dng;
}

/// 6 rows of 8 pixels as lines of JPEG of another length: DNGs have such.
TEST(DngMosaic, ReadsLosslessJpegOfAnyShape)
{
    const Words dn = words(48, 12);
    for (const auto& [lines, columns, components] : { std::tuple { 6, 8, 1 },
                                                      { 6, 4, 2 },
                                                      { 3, 8, 2 },
                                                      { 6, 2, 4 },
                                                      { 3, 16, 1 } })
        EXPECT_EQ(read_all(jpeg_dng({ lines, columns, components, 12, 1, dn }).file()),
                  dn);
}

TEST(DngMosaic, ReadsAnyRowsInAnyOrder)
{
    const Words dn = words(48, 12);
    for (const PixelDng& dng : { jpeg_dng({ 6, 4, 2, 12, 6, dn }),
                                 PixelDng { 12, { packed(dn, 8, 12, false) } } }) {
        std::istringstream stream(dng.file());
        DngMosaic mosaic(stream, "test.dng");
        for (const int first : { 3, 0, 5, 2 }) {
            Words row(8);
            mosaic.read_rows(first, { row.data(), 8, 1, 8 });
            EXPECT_EQ(row, rows_of(dn, first, 1));
        }
        Words row(16);
        EXPECT_THROW(mosaic.read_rows(5, { row.data(), 8, 2, 8 }), Error);
        EXPECT_THROW(mosaic.read_rows(-1, { row.data(), 8, 2, 8 }), Error);
    }
}

TEST(DngMosaic, LinearisesAndTakesTheLastValueBeyondTheTable)
{
    Words dn(48, 1);
    dn[0] = 0;
    dn[1] = 200;
    PixelDng dng { 8, { packed(dn, 8, 8, false) } };
    dng.ifd.shorts(50712, { 70, 500, 900 });
    const Words read = read_all(dng.file());
    EXPECT_EQ(read[0], 70);
    EXPECT_EQ(read[1], 900);
    EXPECT_EQ(read[2], 500);
}

TEST(DngMosaic, SaysWhereTheActiveAreaLies)
{
    PixelDng dng { 16, { packed(words(48, 10), 8, 16, false) } };
    dng.ifd.longs(50829, { 1, 2, 5, 8 });
    std::istringstream stream(dng.file());
    const DngMosaic mosaic(stream, "test.dng");
    EXPECT_EQ(mosaic.storage().active_area.row, 1);
    EXPECT_EQ(mosaic.storage().active_area.col, 2);
    EXPECT_EQ(mosaic.metadata().active_area.width, 6);
    EXPECT_EQ(mosaic.storage().bits, 16);
    EXPECT_FALSE(mosaic.storage().is_jpeg);
}

TEST(DngMosaic, RefusesPixelsThatTheFileCannotHold)
{
    const std::string strip = packed(words(48, 16), 8, 16, false);
    const auto error = [&](auto change) {
        PixelDng dng { 16, { strip } };
        change(dng);
        return error_of(dng.file());
    };
    EXPECT_NE(error([](PixelDng& dng) {
                  dng.shortage = 1;
              }).find("StripByteCounts (279) of chunk 0 is 95 bytes"),
              std::string::npos);
    EXPECT_NE(error([](PixelDng& dng) {
                  dng.move = 1 << 30;
              }).find("StripOffsets (273) of chunk 0 is 96 bytes at byte"),
              std::string::npos);
    EXPECT_NE(error([](PixelDng& dng) {
                  dng.ifd.shorts(258, { 17 });
              }).find("BitsPerSample (258) is 17; allowed: 8 to 16"),
              std::string::npos);
    EXPECT_NE(error([](PixelDng& dng) {
                  dng.ifd.shorts(259, { 8 });
              }).find("Compression (259) is 8; readable are 1 (none) and 7"),
              std::string::npos);
    EXPECT_NE(error([](PixelDng& dng) {
                  dng.ifd.shorts(317, { 2 });
              }).find("Predictor (317) is 2"),
              std::string::npos);
    EXPECT_NE(error([](PixelDng& dng) {
                  dng.ifd.shorts(266, { 2 });
              }).find("FillOrder (266) is 2"),
              std::string::npos);
    EXPECT_NE(error([](PixelDng& dng) {
                  dng.ifd.longs(50974, { 2, 2 });
              }).find("SubTileBlockSize (50974) is not 1 1"),
              std::string::npos);
    EXPECT_NE(error([](PixelDng& dng) {
                  dng.ifd.longs(256, { 65535 }).longs(257, { 65535 });
              }).find("StripByteCounts (279) of chunk 0"),
              std::string::npos);
    EXPECT_NE(error([](PixelDng& dng) {
                  dng.ifd.longs(278, { 1 });
              }).find("StripOffsets (273) has 1 values; allowed: 6"),
              std::string::npos);
}

/// 65535 x 65535 in a few hundred bytes: not even the table of a mosaic is allocated.
TEST(DngMosaic, RefusesJpegOfTooFewBytes)
{
    PixelDng dng = jpeg_dng({ 6, 4, 2, 12, 1, words(48, 12) });
    dng.ifd.longs(256, { 65535 }).longs(257, { 65535 });
    EXPECT_NE(error_of(dng.file()).find("for 65535 x 65535 pixels, which need more"),
              std::string::npos);
}

TEST(DngMosaic, RefusesChunksThatShareTheirBytes)
{
    PixelDng dng { 16, std::vector<std::string>(48, std::string(64, 'x')), { 1, 1 } };
    EXPECT_EQ(error_of(dng.file()), "");
    dng.shared = true;
    EXPECT_NE(error_of(dng.file()).find("chunks overlap"), std::string::npos);
}

TEST(DngMosaic, NamesTheChunkOfDamagedJpeg)
{
    PixelDng dng = jpeg_dng({ 6, 4, 2, 12, 1, words(48, 12) });
    dng.chunks[0].resize(dng.chunks[0].size() - 20);
    EXPECT_NE(error_of(dng.file()).find("test.dng: JPEG of chunk 0 at byte "),
              std::string::npos);
}

/// BlackLevel 64, and what columns and rows add: an even grey is even, and its scale
/// leaves the largest black, 64 + 49 + 40, below white.
TEST(DngMosaic, DevelopsEachPixelFromItsOwnBlack)
{
    Words dn;
    for (int row = 0; row < 6; ++row)
        for (int col = 0; col < 8; ++col) {
            const bool green = (row + col) % 2 != 0;
            const int light = green ? 400 : row % 2 == 0 ? 209 : 229; // the neutral
            dn.push_back(std::uint16_t(64 + 7 * col + (row == 3 ? 40 : -5) + light));
        }
    PixelDng dng { 16, { packed(dn, 8, 16, false) } };
    dng.ifd.signed_rationals(50715, { 0, 7, 14, 21, 28, 35, 42, 49 }, 1);
    dng.ifd.signed_rationals(50716, { -5, -5, -5, 40, -5, -5 }, 1);
    std::istringstream stream(dng.file());
    DngMosaic mosaic(stream, "test.dng");
    std::vector<float> rgb(3 * 48);
    DevelopedDng(mosaic).read_rows(0, 6, rgb.data(), 24);
    for (const float value : rgb)
        EXPECT_NEAR(value, 400.0 / (1023 - 153), 2e-3);
    for (std::size_t i = 3; i < rgb.size(); ++i)
        EXPECT_NEAR(rgb[i], rgb[i % 3], 1e-6);
}

TEST(DngMosaic, KnowsADngThatItCannotRead)
{
    const auto known = [](const std::string& bytes) {
        std::istringstream stream(bytes);
        return is_dng(stream);
    };
    for (const bool big_endian : { false, true })
        for (const bool is_big_tiff : { false, true }) {
            const std::string whole = file_of(camera_tags(), big_endian, is_big_tiff);
            EXPECT_TRUE(known(whole));
            // What is cut off behind the DNG's own tags.
            EXPECT_TRUE(known(whole.substr(0, whole.size() - 40)));
        }
    EXPECT_TRUE(known(file_of(camera_tags().without(50706))));
    std::string crowded = file_of(camera_tags(), false, true);
    const std::size_t ifd0 = static_cast<unsigned char>(crowded[8])
        + 256 * static_cast<unsigned char>(crowded[9]);
    crowded.replace(ifd0, 8, 8, '\x7F'); // says that it has 2^63 entries
    EXPECT_TRUE(known(crowded));
    EXPECT_FALSE(known(file_of(raw_tags())));
    EXPECT_FALSE(known("II*"));
    EXPECT_FALSE(known(""));
}

class Written : public cg2raw::testing::InFolder { };

/// Of our writer's files: strips and tiles, with and without a preview; 0.5 g of the
/// neutral is grey 0.5 in the picture, to a DN.
TEST_F(Written, ComesBackAndDevelops)
{
    constexpr Size frame { 150, 70 };
    DngDescription description = cg2raw::testing::description_of(frame);
    const auto dn = cg2raw::testing::mosaic_of(frame);
    for (const Compression compression :
         { Compression::none, Compression::ljpeg, Compression::ljpeg_2d })
        for (const bool preview : { false, true }) {
            DngOptions options;
            options.compression = compression;
            options.preview = preview;
            write_dng(path(), cg2raw::testing::plane_of(dn, frame), description,
                      options);
            EXPECT_EQ(read_all(cg2raw::testing::bytes_of(path())), dn);
        }
    Words grey;
    for (int i = 0; i < frame.width * frame.height; ++i) {
        const int color = description.cfa.color({ i / frame.width, i % frame.width });
        const double neutral = description.as_shot_neutral[std::size_t(color)];
        grey.push_back(std::uint16_t(512.5 + 0.5 * neutral * (16383 - 512)));
    }
    write_dng(path(), cg2raw::testing::plane_of(grey, frame), description, {});
    std::ifstream stream(path(), std::ios::binary);
    DngMosaic mosaic(stream, path());
    DevelopedDng picture(mosaic);
    constexpr std::ptrdiff_t pitch = std::ptrdiff_t(3) * frame.width;
    std::vector<float> rgb(std::size_t(3 * pitch));
    picture.read_rows(0, 2, rgb.data(), pitch);
    picture.read_rows(frame.height - 1, 1, rgb.data() + 2 * pitch, pitch);
    for (const float value : rgb)
        EXPECT_NEAR(value, 0.5F, 2e-4); // a DN over the darkest neutral, times rows
}

} // namespace
} // namespace cg2raw::test

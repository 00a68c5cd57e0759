// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "writer/preview.h"

#include "writer_fixture.h"

#include <cmath>

namespace cg2raw {
namespace {

using namespace cg2raw::testing;

/// A mosaic in which each colour has one signal, 0..1 above black.
std::vector<std::uint16_t> flat(const DngDescription& description, const Vec3& signal)
{
    const Size size = description.size;
    std::vector<std::uint16_t> dn;
    for (int row = 0; row < size.height; ++row)
        for (int col = 0; col < size.width; ++col) {
            const CfaPattern& cfa = description.cfa;
            const std::size_t site
                = std::size_t(row % cfa.height * cfa.width + col % cfa.width);
            const double black = description.black_level[site];
            const int color = description.cfa.color({ row, col });
            dn.push_back(std::uint16_t(std::lround(black
                                                   + (description.white_level - black)
                                                       * signal[std::size_t(color)])));
        }
    return dn;
}

std::array<int, 3> pixel_of(const DngDescription& description, const Vec3& signal)
{
    Preview preview(description);
    const std::vector<std::uint16_t> dn = flat(description, signal);
    const std::vector<std::uint8_t>& pixels
        = preview.add_rows(plane_of(dn, description.size), parallel_threads(1));
    for (std::size_t i = 0; i < pixels.size(); ++i)
        EXPECT_EQ(pixels[i], pixels[i % 3]) << "not flat at " << i / 3;
    return { pixels[0], pixels[1], pixels[2] };
}

TEST(Preview, SizesUpToALongestSideOf1024)
{
    const auto size_of = [](Size size) {
        const Size preview = Preview(description_of(size)).size();
        return std::array<int, 2> { preview.width, preview.height };
    };
    EXPECT_EQ(size_of({ 4032, 3024 }), (std::array<int, 2> { 1008, 756 }));
    EXPECT_EQ(size_of({ 2048, 100 }), (std::array<int, 2> { 1024, 50 }));
    EXPECT_EQ(size_of({ 2050, 101 }), (std::array<int, 2> { 512, 25 }));
    EXPECT_EQ(size_of({ 3, 2 }), (std::array<int, 2> { 1, 1 }));
    EXPECT_EQ(size_of({ 65535, 2 }), (std::array<int, 2> { 1023, 1 }));
}

TEST(Preview, SidesShorterThanABlock)
{
    for (const Size size : { Size { 2, 5000 }, Size { 3, 3000 }, Size { 61, 65535 },
                             Size { 65535, 4 }, Size { 5001, 3 } }) {
        DngDescription description = description_of(size);
        description.as_shot_neutral = { 1, 1, 1 };
        description.srgb_from_balanced = diagonal({ 1, 1, 1 });
        EXPECT_EQ(pixel_of(description, { 0.18, 0.18, 0.18 }),
                  (std::array<int, 3> { 118, 118, 118 }))
            << size.width << " x " << size.height;
    }
}

TEST(Preview, NeutralIsGreyInEveryPhase)
{
    for (const char* cfa : { "rggb", "grbg", "gbrg", "bggr" }) {
        DngDescription description = description_of({ 101, 67 });
        description.cfa = cfa_from_name(cfa);
        description.black_level = { 500, 510, 520, 530 }; // each site its own
        // 18 % grey is 118 in sRGB (IEC 61966-2-1: 255 x 0.4614 = 117.7).
        EXPECT_EQ(pixel_of(description, { 0.09, 0.18, 0.126 }),
                  (std::array<int, 3> { 118, 118, 118 }));
        EXPECT_EQ(pixel_of(description, { 0, 0, 0 }), (std::array<int, 3> { 0, 0, 0 }));
    }
}

TEST(Preview, NeutralIsGreyOnXTrans)
{
    DngDescription description = description_of({ 101, 67 });
    description.cfa = cfa_from_name("ggrggbggbggrbrgrbgggbggrggrggbrbgbrg");
    description.black_level.clear();
    for (int site = 0; site < 36; ++site)
        description.black_level.push_back(500 + 10 * site);
    EXPECT_EQ(pixel_of(description, { 0.09, 0.18, 0.126 }),
              (std::array<int, 3> { 118, 118, 118 }));
    EXPECT_EQ(pixel_of(description, { 0, 0, 0 }), (std::array<int, 3> { 0, 0, 0 }));
    const Size size = Preview(description).size();
    EXPECT_EQ(size.width, 16);
    EXPECT_EQ(size.height, 11);
}

TEST(Preview, WhiteIsTheNeutralOverItsMaximum)
{
    DngDescription description = description_of({ 64, 64 });
    description.as_shot_neutral = { 1.25, 1.0, 0.5 }; // tungsten
    const std::array<int, 3> white { 255, 255, 255 };
    EXPECT_EQ(pixel_of(description, { 1.0, 0.8, 0.4 }), white);
    EXPECT_EQ(pixel_of(description, { 1.0, 1.0, 1.0 }), white) << "saturated: no cast";
    EXPECT_LT(pixel_of(description, { 0.9, 0.72, 0.36 })[1], 250);
}

TEST(Preview, ColoursGoThroughTheMatrix)
{
    DngDescription description = description_of({ 64, 64 });
    description.as_shot_neutral = { 1, 1, 1 };
    description.srgb_from_balanced = { { 0, 1, 0, 0, 0, 1, 1, 0, 0 } };
    EXPECT_EQ(pixel_of(description, { 0.0, 0.18, 1.0 }),
              (std::array<int, 3> { 118, 255, 0 }));
}

TEST(Preview, SameBytesHoweverRowsArrive)
{
    const Size size { 2611, 403 }; // blocks of 4, and some left over
    const DngDescription description = description_of(size);
    const std::vector<std::uint16_t> dn = mosaic_of(size);
    const auto pixels = [&](int rows_at_once, int threads) {
        Preview preview(description);
        std::vector<std::uint8_t> all;
        for (int row = 0; row < size.height; row += rows_at_once) {
            const std::vector<std::uint8_t>& some = preview.add_rows(
                { dn.data() + row * size.width, size.width,
                  std::min(rows_at_once, size.height - row), size.width },
                parallel_threads(threads));
            all.insert(all.end(), some.begin(), some.end());
        }
        EXPECT_EQ(all.size(), 3U * 652 * 100);
        return all;
    };
    const std::vector<std::uint8_t> whole = pixels(size.height, 1);
    EXPECT_EQ(pixels(size.height, 3), whole);
    for (const int rows : { 1, 3, 4, 7, 130 })
        EXPECT_EQ(pixels(rows, 2), whole) << rows;
}

} // namespace
} // namespace cg2raw

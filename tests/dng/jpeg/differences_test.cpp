// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "jpeg/differences.h"

#include "jpeg/predictor.h"

#include <gtest/gtest.h>

namespace cg2raw {
namespace {

constexpr int width = 64, height = 32;
using Samples = std::vector<std::uint16_t>;

/// 8 bits without a pattern.
int noise(int i)
{
    const unsigned state = unsigned(i + 1) * 2654435761U;
    return int((state ^ state >> 15) * 2246822519U >> 24);
}

/// A tile of lines of @p rows rows in which @p predictor foresees all but the first
/// line and the first column.
template <int predictor> Samples planted(int rows, int components)
{
    const int line = rows * width;
    Samples samples;
    for (int i = 0; i < width * height; ++i) {
        if (i < line || i % line < components) {
            samples.push_back(std::uint16_t(20000 + 64 * noise(i)));
            continue;
        }
        const auto at = [&](int back) { return int(samples[std::size_t(i - back)]); };
        samples.push_back(std::uint16_t(
            predicted<predictor>(at(components), at(line), at(line + components))));
    }
    return samples;
}

template <int predictor> void expect_found()
{
    Differences scratch;
    for (const int rows : { 1, 2 })
        for (const int components : { 1, 2 }) {
            const Samples samples = planted<predictor>(rows, components);
            const JpegCoding coding
                = best_coding(samples.data(), width, height, components, scratch);
            EXPECT_EQ(coding.predictor, predictor) << rows << " rows";
            EXPECT_EQ(coding.lines.components, components);
            EXPECT_EQ(coding.lines.width * coding.lines.count, width * height);
            // What a line of one row foresees, those of two may foresee as well.
            if (rows == 2 && predictor > 1) {
                EXPECT_EQ(coding.lines.width, rows * width) << predictor;
            }
        }
}

TEST(BestCoding, IsThePlantedOne)
{
    expect_found<1>();
    expect_found<2>();
    expect_found<3>();
    expect_found<4>();
    expect_found<5>();
    expect_found<6>();
    expect_found<7>();
}

TEST(BestCoding, OfEquallyGoodOnesIsTheFirst)
{
    Differences scratch;
    const Samples flat(std::size_t(width * height), 700);
    const JpegCoding coding = best_coding(flat.data(), width, height, 2, scratch);
    EXPECT_EQ(coding.predictor, 1);
    EXPECT_EQ(coding.lines.width, width);
}

TEST(Differences, OfAFirstLineAndAFirstColumn)
{
    // Two lines of two pixels of two components, 10 bits: half the range is 512.
    const Samples samples { 500, 600, 510, 590, 503, 602, 700, 100 };
    Differences differences;
    find_differences({ { samples.data(), 4, 2, 2 }, 4 }, 10, differences);
    const std::vector<int> expected { -12, 88, 10, -10, 3, 2, 187, -492 };
    std::vector<int> found;
    for (const std::uint16_t value : differences.values)
        found.push_back(std::int16_t(value));
    EXPECT_EQ(found, expected);
    EXPECT_EQ(differences.sizes,
              (std::vector<std::uint8_t> { 4, 7, 4, 4, 2, 2, 8, 9 }));
    const SizeHistogram histogram = histogram_of(differences.sizes);
    EXPECT_EQ(histogram[2], 2U);
    EXPECT_EQ(histogram[4], 3U);
    EXPECT_EQ(histogram[9], 1U);
}

TEST(Differences, SizesOfTheWholeRange)
{
    // From the left, in one line: 0, -1, 1, 32767, -32768 modulo 2^16.
    const Samples samples { 32768, 32767, 32768, 65535, 32767 };
    Differences differences;
    find_differences({ { samples.data(), 5, 1, 1 }, 1 }, 16, differences);
    EXPECT_EQ(differences.sizes, (std::vector<std::uint8_t> { 0, 1, 1, 15, 16 }));
}

} // namespace
} // namespace cg2raw

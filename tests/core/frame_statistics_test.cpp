// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file FrameStatistics on sizes that divide by nothing; what it says is tested in
/// Python, against a plain version.
#include "cg2raw/frame_statistics.h"

#include <gtest/gtest.h>

namespace cg2raw {
namespace {

using Frame = std::vector<std::uint16_t>;

/// Frames of noise, with a hot pixel, a ray in one of them and a dead column.
std::vector<Frame> frames_of(Size size, int count)
{
    std::vector<Frame> frames;
    std::uint32_t state = 1;
    for (int n = 0; n < count; ++n) {
        Frame frame(std::size_t(size.width) * std::size_t(size.height));
        for (std::uint16_t& sample : frame) {
            state = state * 1664525U + 1013904223U;
            sample = std::uint16_t(200U + (state >> 28U) + ((state >> 20U) & 15U));
        }
        frame[0] = 3000;
        frame.back() = n == 1 ? 60000 : frame.back();
        for (int row = 0; size.width > 20 && row < size.height; ++row)
            frame[std::size_t(row * size.width) + 9] = 0;
        frames.push_back(std::move(frame));
    }
    return frames;
}

FrameStatistics measured(Size size, int side, int threads)
{
    const auto frames = frames_of(size, 5);
    const auto parallel = parallel_threads(threads);
    const auto plane = [&](std::size_t n) {
        return Plane<const std::uint16_t> { frames[n].data(), size.width, size.height,
                                            size.width };
    };
    FrameStatistics found(size, side, 2);
    for (std::size_t n = 0; n < frames.size(); ++n)
        found.look(n > 3 ? 1 : 0, plane(n), parallel);
    found.mask(parallel);
    for (std::size_t n = 0; n < 4; n += 2) {
        const auto other = plane(n + 1);
        found.measure(0, plane(n), &other, parallel);
    }
    found.measure(1, plane(4), nullptr, parallel);
    return found;
}

class Sizes : public testing::TestWithParam<std::tuple<Size, int>> { };

TEST_P(Sizes, ThreadsDoNotMatter)
{
    const auto [size, side] = GetParam();
    const auto one = measured(size, side, 1), three = measured(size, side, 3);
    const auto alone = parallel_threads(1), together = parallel_threads(3);
    EXPECT_EQ(one.products(alone), three.products(together));
    EXPECT_EQ(one.lag_counts(), three.lag_counts());
    ASSERT_EQ(one.planes().size(), std::size_t(side * side));
    for (std::size_t p = 0; p < one.planes().size(); ++p) {
        EXPECT_EQ(one.masks()[p].samples, three.masks()[p].samples);
        for (std::size_t g = 0; g < 2; ++g) {
            const PlaneOfGroup& a = one.groups()[g].planes[p];
            const PlaneOfGroup& b = three.groups()[g].planes[p];
            EXPECT_EQ(a.scatter, b.scatter);
            EXPECT_EQ(a.levels, b.levels);
            EXPECT_EQ(a.residuals, b.residuals);
            EXPECT_EQ(a.noise, b.noise);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(FrameStatistics, Sizes,
                         testing::Values(std::tuple { Size { 131, 67 }, 1 },
                                         std::tuple { Size { 1, 40 }, 1 },
                                         std::tuple { Size { 40, 1 }, 1 },
                                         std::tuple { Size { 131, 67 }, 2 },
                                         std::tuple { Size { 13, 7 }, 2 },
                                         std::tuple { Size { 200, 129 }, 6 }));

TEST(FrameStatistics, RefusesFramesThatAreNotOfTheFirst)
{
    const auto frames = frames_of({ 8, 6 }, 1);
    const auto parallel = parallel_threads(1);
    FrameStatistics found({ 8, 6 }, 1, 2);
    const Plane<const std::uint16_t> frame { frames[0].data(), 8, 6, 8 };
    EXPECT_THROW(found.look(0, frame.rows(0, 5), parallel), Error);
    EXPECT_THROW(found.look(2, frame, parallel), Error);
    EXPECT_THROW(FrameStatistics({ 8, 6 }, 7, 1), Error);
    EXPECT_THROW(found.measure(0, frame, nullptr, parallel), Error);
    found.look(0, frame, parallel);
    found.look(1, frame, parallel);
    EXPECT_THROW(found.look(0, frame, parallel), Error);
    found.mask(parallel);
    EXPECT_THROW(found.measure(2, frame, nullptr, parallel), Error);
    EXPECT_THROW(found.measure(0, frame.rows(0, 5), nullptr, parallel), Error);
}

} // namespace
} // namespace cg2raw

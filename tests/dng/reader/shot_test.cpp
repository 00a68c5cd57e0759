// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file CinemaDNG's four tags, as files of many makers write them.
#include "reader_test.h"

#include <gtest/gtest.h>

namespace cg2raw::test {
namespace {

constexpr int time_codes = 51043, frame_rate = 51044, reel_name = 51081,
              camera_label = 51105;

/// The text of a rate, or "none".
std::string rate_of(const Ifd& ifd)
{
    const auto rate = read(ifd).shot.frame_rate;
    return rate ? text_of(*rate) : "none";
}

std::string code_of(const Ifd& ifd)
{
    const auto code = read(ifd).shot.time_code;
    return code ? text_of(*code) : "none";
}

TEST(DngShot, IsReadInBothByteOrders)
{
    const Ifd ifd = tiny_dng()
                        .signed_rationals(frame_rate, { 60000 }, 1001)
                        .bytes(time_codes, { 0xD2, 0x83, 2, 1, 0, 0, 0, 0 })
                        .text(reel_name, "A001 ")
                        .text(camera_label, "B");
    for (const bool big_endian : { false, true }) {
        const Shot shot = read(ifd, big_endian).shot;
        EXPECT_EQ(text_of(*shot.frame_rate), "60000/1001");
        // The byte of frames: 12, 0x40 for dropped numbers, 0x80 for a colour frame. In
        // that of seconds 0x80 marks the second frame of a pair.
        EXPECT_EQ(text_of(*shot.time_code), "01:02:03;25");
        EXPECT_EQ(shot.reel_name, "A001");
        EXPECT_EQ(shot.camera_label, "B");
    }
}

TEST(DngShot, ARateIsAnyNumberAboveZero)
{
    EXPECT_EQ(rate_of(tiny_dng().fractions(frame_rate, { { 48, 2 } })), "24");
    EXPECT_EQ(rate_of(tiny_dng().fractions(frame_rate, { { 2997, 125 } })), "2997/125");
    EXPECT_EQ(rate_of(tiny_dng().shorts(frame_rate, { 25 })), "25");
    EXPECT_EQ(rate_of(tiny_dng()), "none");
    EXPECT_EQ(rate_of(tiny_dng().fractions(frame_rate, { { 0, 0 } })), "none");
    EXPECT_EQ(rate_of(tiny_dng().fractions(frame_rate, { { 24, 0 } })), "none");
    EXPECT_EQ(rate_of(tiny_dng().signed_rationals(frame_rate, { -24 }, 1)), "none");
    EXPECT_EQ(rate_of(tiny_dng().fractions(frame_rate, { { 0x80000001, 1 } })), "none");
    EXPECT_EQ(rate_of(tiny_dng().fractions(frame_rate, { { 20000, 1 } })), "none");
    EXPECT_EQ(rate_of(tiny_dng().doubles(frame_rate, { 24.0 })), "none");
    EXPECT_EQ(rate_of(tiny_dng().text(frame_rate, "24")), "none");
}

TEST(DngShot, ATimeCodeIsTheFirstOfAny)
{
    const auto with = [](const std::vector<std::uint64_t>& bytes) {
        return tiny_dng().bytes(time_codes, bytes);
    };
    EXPECT_EQ(code_of(with({ 0x23, 0x59, 0x59, 0x23, 0, 0, 0, 0 })), "23:59:59:23");
    EXPECT_EQ(code_of(with({ 1, 2, 3, 4, 0, 0, 0, 0, 9, 9, 9, 9, 0, 0, 0, 0 })),
              "04:03:02:01");
    EXPECT_EQ(code_of(with({ 0x0A, 0, 0, 0, 0, 0, 0, 0 })), "none");
    EXPECT_EQ(code_of(with({ 0, 0x75, 0, 0, 0, 0, 0, 0 })), "none");
    EXPECT_EQ(code_of(with({ 1, 2, 3 })), "none");
    EXPECT_EQ(code_of(tiny_dng()), "none");
}

TEST(DngShot, IsNotThatOfAFileWithThisReference)
{
    const Shot reference = read(tiny_dng()
                                    .fractions(frame_rate, { { 24, 1 } })
                                    .bytes(time_codes, { 4, 3, 2, 1, 0, 0, 0, 0 })
                                    .text(reel_name, "A001")
                                    .text(camera_label, "B"))
                               .shot;
    const Shot still = merged(reference, Shot());
    EXPECT_FALSE(still.frame_rate || still.time_code);
    EXPECT_EQ(still.reel_name + still.camera_label, "");
    Shot image;
    image.frame_rate = FrameRate { 25, 1 };
    image.time_code = TimeCode { 10, 0, 0, 1, false };
    image.reel_name = "mine";
    const Shot frame = merged(reference, image);
    EXPECT_EQ(text_of(*frame.frame_rate), "25");
    EXPECT_EQ(text_of(*frame.time_code), "10:00:00:01");
    EXPECT_EQ(frame.reel_name, "mine");
    EXPECT_EQ(frame.camera_label, "");
}

} // namespace
} // namespace cg2raw::test

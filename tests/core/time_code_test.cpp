// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Time codes against the counts that SMPTE ST 12-1 gives, and rates as written.
#include "cg2raw/time_code.h"
#include "cg2raw/types.h"

#include <gtest/gtest.h>

namespace cg2raw {
namespace {

const FrameRate film { 24, 1 }, ntsc { 30000, 1001 }, ntsc_60 { 60000, 1001 };

std::string after(const char* first, FrameRate rate, std::uint64_t frames)
{
    return text_of(advanced(time_code_from_text(first), rate, frames));
}

template <class Work> std::string failure(const Work& work)
{
    try {
        work();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

TEST(FrameRate, IsWrittenInManyWays)
{
    const std::pair<const char*, const char*> words[] = {
        { "24", "24" },
        { "24.0", "24" },
        { "48/2", "24" },
        { "23.976", "24000/1001" },
        { "23.98", "24000/1001" },
        { "23.976024", "24000/1001" },
        { "29.97", "30000/1001" },
        { "47.952", "48000/1001" },
        { "59.94", "60000/1001" },
        { "119.88", "120000/1001" },
        { "24000/1001", "24000/1001" },
        { "12.5", "25/2" },
        { "0.001", "1/1000" },
        { "10000", "10000" },
    };
    for (const auto& [word, text] : words)
        EXPECT_EQ(text_of(frame_rate_from_text(word)), text) << word;
}

TEST(FrameRate, IsRefusedWhereItIsNone)
{
    for (const char* word : { "", "0", "-24", "nan", "inf", "24fps", "24/0", "0/1",
                              "24/", "/1", "1e9", "0.0001", "24.5/2", "10001" })
        EXPECT_NE(failure([&] { frame_rate_from_text(word); }).find("24000/1001"),
                  std::string::npos)
            << word;
}

// SMPTE ST 12-1, 5.2.2: at 29.97 frames a second the numbers 0 and 1 of each minute are
// left out, but of every tenth: 17982 frames in ten minutes, 107892 in an hour.
TEST(TimeCode, DropsNumbersAsSmpteDoes)
{
    EXPECT_EQ(after("00:00:00;00", ntsc, 1799), "00:00:59;29");
    EXPECT_EQ(after("00:00:00;00", ntsc, 1800), "00:01:00;02");
    EXPECT_EQ(after("00:00:00;00", ntsc, 3597), "00:01:59;29");
    EXPECT_EQ(after("00:00:00;00", ntsc, 3598), "00:02:00;02");
    EXPECT_EQ(after("00:00:00;00", ntsc, 17981), "00:09:59;29");
    EXPECT_EQ(after("00:00:00;00", ntsc, 17982), "00:10:00;00");
    EXPECT_EQ(after("00:00:00;00", ntsc, 107892), "01:00:00;00");
    EXPECT_EQ(after("00:00:59;59", ntsc_60, 1), "00:01:00;04");
    EXPECT_EQ(after("00:00:00:00", ntsc, 1800), "00:01:00:00");
}

TEST(TimeCode, PassesMidnight)
{
    EXPECT_EQ(after("23:59:59:23", film, 1), "00:00:00:00");
    EXPECT_EQ(after("23:59:59;29", ntsc, 1), "00:00:00;00");
    EXPECT_EQ(after("01:00:00:00", film, 24 * 86400 + 25), "01:00:01:01");
}

TEST(TimeCode, EachFrameOfTenMinutesHasItsOwn)
{
    std::string last;
    for (std::uint64_t frame = 0; frame < 17982; ++frame) {
        const TimeCode code = advanced({ 9, 50, 0, 0, true }, ntsc, frame);
        EXPECT_NO_THROW(check(code, ntsc));
        EXPECT_GT(text_of(code), last);
        last = text_of(code);
    }
    EXPECT_EQ(last, "09:59:59;29");
}

TEST(TimeCode, IsRefusedAtARateThatDoesNotCountSo)
{
    const auto fails = [](const char* code, FrameRate rate) {
        return failure([&] { check(time_code_from_text(code), rate); });
    };
    EXPECT_EQ(
        fails("01:00:00;00", film),
        "time code 01:00:00;00 drops frame numbers, as only 29.97 and 59.94 frames "
        "a second do, and the rate is 24: write it 01:00:00:00");
    EXPECT_NE(fails("01:00:00;00", { 30, 1 }).find("rate is 30"), std::string::npos);
    EXPECT_NE(fails("01:00:00:24", film).find("from 0 to 23"), std::string::npos);
    EXPECT_NE(fails("00:01:00;01", ntsc).find("first is 00:01:00;02"),
              std::string::npos);
    EXPECT_NE(fails("00:00:00:00", { 120, 1 }).find("up to 60"), std::string::npos);
    EXPECT_NE(fails("00:00:00:00", { 25, 2 }).find("rate is 25/2"), std::string::npos);
    EXPECT_EQ(fails("00:10:00;00", ntsc) + fails("00:00:00:23", { 24000, 1001 }), "");
}

TEST(TimeCode, IsRefusedWhereItIsNone)
{
    for (const char* word :
         { "", "1:00:00:00", "01-00-00-00", "24:00:00:00", "00:60:00:00", "00:00:60:00",
           "0a:00:00:00", "01:00:00:00 ", "01:00:00" })
        EXPECT_NE(failure([&] { time_code_from_text(word); }).find("hh:mm:ss:ff"),
                  std::string::npos)
            << word;
}

using Bytes = std::array<std::uint8_t, 8>;

TEST(TimeCode, IsBinaryCodedDecimalInSmpte331)
{
    EXPECT_EQ(smpte_331m({ 12, 34, 56, 23, false }, film),
              (Bytes { 0x23, 0x56, 0x34, 0x12, 0, 0, 0, 0 }));
    EXPECT_EQ(smpte_331m({ 1, 2, 3, 4, true }, ntsc),
              (Bytes { 0x44, 0x03, 0x02, 0x01, 0, 0, 0, 0 }));
    // SMPTE ST 12-1:2014, 12.1: pairs, and where the second of a pair is marked.
    EXPECT_EQ(smpte_331m({ 0, 0, 1, 47, false }, FrameRate { 48, 1 }),
              (Bytes { 0x23, 0x81, 0, 0, 0, 0, 0, 0 }));
    EXPECT_EQ(smpte_331m({ 3, 0, 1, 49, false }, FrameRate { 50, 1 }),
              (Bytes { 0x24, 0x01, 0, 0x83, 0, 0, 0, 0 }));
    EXPECT_EQ(smpte_331m({ 3, 0, 1, 48, false }, FrameRate { 50, 1 }),
              (Bytes { 0x24, 0x01, 0, 0x03, 0, 0, 0, 0 }));
    EXPECT_THROW(smpte_331m({ 0, 0, 0, 40, false }, std::nullopt), Error);
}

TEST(TimeCode, IsReadAsItIsPacked)
{
    const std::optional<FrameRate> rates[]
        = { std::nullopt, film, ntsc, ntsc_60, FrameRate { 50, 1 } };
    for (const auto& rate : rates)
        for (const TimeCode code : { TimeCode { 12, 34, 56, 17, false },
                                     TimeCode { 23, 59, 59, 29, true } }) {
            const Bytes bytes = smpte_331m(code, rate);
            const std::uint32_t packed = std::uint32_t(bytes[3]) << 24
                | std::uint32_t(bytes[2]) << 16 | std::uint32_t(bytes[1]) << 8
                | bytes[0];
            const auto read = time_code_from_packed(packed, rate);
            ASSERT_TRUE(read);
            EXPECT_EQ(text_of(*read), text_of(code));
        }
    EXPECT_FALSE(time_code_from_packed(0xffffffff, film));
    EXPECT_FALSE(time_code_from_packed(0x0000600a, film));
}

} // namespace
} // namespace cg2raw

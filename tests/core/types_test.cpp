// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/types.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace cg2raw {
namespace {

std::string message_of(const std::string& text) { return Error(text).what(); }

TEST(Error, SaysWhatItIsGiven)
{
    for (const char* text : { "", "a.dng: is no DNG", "caf\xc3\xa9 \xe4\xb8\x80: none",
                              "\xf0\x9f\x93\xb7.dng" })
        EXPECT_EQ(message_of(text), text);
}

TEST(Error, IsOneLineOfUtf8)
{
    const std::pair<std::string, std::string> texts[] = {
        { "a\nb\rc\td\x7f", "a?b?c?d?" },
        { std::string("a\0b", 3), "a?b" },
        { "\x1b[2J", "?[2J" }, // clears a terminal
        { "\xc2\x9b\x32J", "?2J" }, // the same in one character
        { "\xe2\x80\xa8", "?" }, // a separator of lines
        { "caf\xe9", "caf?" }, // Latin 1
        { "\xc0\xaf", "??" }, // not the shortest form
        { "\xed\xa0\x80", "???" }, // half of a pair
        { "\xf4\x90\x80\x80", "????" }, // beyond the last character
        { "\xe4\xb8", "??" }, // cut off
    };
    for (const auto& [text, line] : texts)
        EXPECT_EQ(message_of(text), line);
}

TEST(Error, KeepsStartAndEndOfALongMessage)
{
    const std::string longest(Error::longest_message, 'a');
    EXPECT_EQ(message_of(longest), longest);
    const std::string cut = message_of("start " + longest + " end");
    EXPECT_LE(cut.size(), Error::longest_message);
    EXPECT_EQ(cut.substr(0, 7), "start a");
    EXPECT_EQ(cut.substr(cut.size() - 5), "a end");
    EXPECT_NE(cut.find("a ... a"), cut.npos);
}

TEST(Error, CutsBetweenCharacters)
{
    for (const char* character : { "\xc3\xa9", "\xe4\xb8\x80", "\xf0\x9f\x93\xb7" }) {
        std::string text = "a";
        while (text.size() <= Error::longest_message)
            text += character;
        EXPECT_EQ(message_of(message_of(text)).find('?'), std::string::npos);
    }
}

/// IEEE 754 binary16: sign, 5 bits of exponent, 10 of fraction.
float number_of(int half)
{
    const int exponent = half >> 10 & 31, fraction = half & 1023;
    const double size = exponent == 31
        ? std::numeric_limits<double>::infinity()
        : std::ldexp(exponent ? 1024 + fraction : fraction, std::max(exponent, 1) - 25);
    return float(half & 0x8000 ? -size : size);
}

TEST(FloatFromHalf, IsEachOfThem)
{
    std::vector<std::uint16_t> halves(65536);
    std::iota(halves.begin(), halves.end(), std::uint16_t(0));
    std::vector<float> floats(halves.size());
    float_from_half(halves.data(), int(halves.size()), floats.data());
    for (int half = 0; half < int(halves.size()); ++half) {
        const float found = floats[std::size_t(half)];
        if ((half & 0x7fff) > 0x7c00)
            EXPECT_TRUE(std::isnan(found)) << half;
        else
            EXPECT_EQ(found, number_of(half)) << half;
    }
}

} // namespace
} // namespace cg2raw

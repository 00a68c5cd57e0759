// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Frame rates as people and files write them.
#include "cg2raw/time_code.h"
#include "cg2raw/types.h"

#include "platform/numbers.h"
#include "text.h"

#include <cmath>
#include <numeric>

namespace cg2raw {
namespace {

constexpr double least = 0.001, most = 10000.0;
constexpr std::int32_t largest = 1000000000;
/// How far the short forms of N x 1000/1001 are off: 23.98 is by 0.004.
constexpr double ntsc_rounding = 0.005;

[[noreturn]] void fail(std::string_view text)
{
    throw Error("frame rate \"" + std::string(text)
                + "\" must be frames per second from 0.001 to 10000, as in 24, 23.976 "
                  "or 24000/1001");
}

FrameRate lowest(std::int64_t numerator, std::int64_t denominator)
{
    const std::int64_t common = std::gcd(numerator, denominator);
    return { std::int32_t(numerator / common), std::int32_t(denominator / common) };
}

bool is_part(double number)
{
    return number >= 1.0 && number <= largest && number == std::floor(number);
}

} // namespace

FrameRate frame_rate_from_text(std::string_view text)
{
    const auto slash = text.find('/');
    const double over = number_in(text.substr(0, slash));
    const double under = slash == text.npos ? 1.0 : number_in(text.substr(slash + 1));
    const double value = over / under;
    if (!(value >= least && value <= most))
        fail(text);
    if (slash != text.npos) {
        if (!is_part(over) || !is_part(under))
            fail(text);
        return lowest(std::int64_t(over), std::int64_t(under));
    }
    const double up = std::ceil(value);
    if (value < up && int(up) % 6 == 0
        && std::abs(value - up * 1000.0 / 1001.0) < ntsc_rounding)
        return lowest(std::int64_t(up) * 1000, 1001);
    return lowest(std::int64_t(std::round(value * 1000.0)), 1000);
}

std::string text_of(FrameRate rate)
{
    const std::string whole = std::to_string(rate.numerator);
    return rate.denominator == 1 ? whole
                                 : whole + "/" + std::to_string(rate.denominator);
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/time_code.h"

#include "cg2raw/types.h"
#include "text.h"

#include <cstdio>

namespace cg2raw {
namespace {

constexpr int hours_of_day = 24, minutes_of_hour = 60, seconds_of_minute = 60;
/// The most that SMPTE ST 12-1 counts in a second; above the first, in pairs.
constexpr int most_single = 30, most_frames = 60;
/// Two binary-coded digits, the higher of two bits.
constexpr int most_digits = 39;

/// Bits of a packed time code, and of the bytes of SMPTE 331M.
constexpr std::uint32_t drop_bit = 0x40, mark_bit = 0x80;

/// The rate rounded up.
int rounded_up(FrameRate rate)
{
    return (rate.numerator + rate.denominator - 1) / rate.denominator;
}

/// Frames that time codes count in a second. Throws Error if they count none.
int counted(FrameRate rate)
{
    if (!has_time_codes(rate))
        throw Error("time codes count whole frames a second, up to 60, and the rate is "
                    + text_of(rate)
                    + ": leave the time code out, or give the rate it counts");
    return rounded_up(rate);
}

bool may_drop(FrameRate rate)
{
    return rate.denominator == 1001
        && (rate.numerator == 30000 || rate.numerator == 60000);
}

/// Numbers that are left out at the start of each minute but every tenth.
int dropped(FrameRate rate) { return counted(rate) / 15; }

bool is_clock(const TimeCode& code)
{
    return code.hours < hours_of_day && code.minutes < minutes_of_hour
        && code.seconds < seconds_of_minute;
}

/// The second of the marked places is that of 25 pairs a second.
int mark_byte(const std::optional<FrameRate>& rate)
{
    return rate && rounded_up(*rate) == 50 ? 3 : 1;
}

bool in_pairs(const std::optional<FrameRate>& rate)
{
    return rate && rounded_up(*rate) > most_single;
}

int digits_of(std::uint32_t byte, std::uint32_t mask)
{
    const int tens = int((byte & mask) >> 4), units = int(byte & 0xf);
    return units > 9 || tens > 9 ? -1 : 10 * tens + units;
}

std::uint8_t coded(int number) { return std::uint8_t(number / 10 << 4 | number % 10); }

/// The number of the frame since midnight, dropped numbers not counted.
std::int64_t frame_of_day(const TimeCode& code, FrameRate rate)
{
    const std::int64_t minutes = code.hours * minutes_of_hour + code.minutes;
    const std::int64_t number
        = (minutes * seconds_of_minute + code.seconds) * counted(rate) + code.frames;
    return code.drop_frame ? number - dropped(rate) * (minutes - minutes / 10) : number;
}

/// The inverse of frame_of_day.
TimeCode code_of(std::int64_t frame, FrameRate rate, bool drop_frame)
{
    const std::int64_t per_second = counted(rate);
    if (drop_frame) {
        const std::int64_t left_out = dropped(rate);
        const std::int64_t minute = seconds_of_minute * per_second - left_out;
        const std::int64_t ten_minutes = 10 * minute + left_out;
        const std::int64_t in_ten = frame % ten_minutes;
        const std::int64_t short_minutes
            = in_ten < left_out ? 0 : (in_ten - left_out) / minute;
        frame += left_out * (9 * (frame / ten_minutes) + short_minutes);
    }
    const std::int64_t seconds = frame / per_second;
    const std::int64_t minutes = seconds / seconds_of_minute;
    return { int(minutes / minutes_of_hour) % hours_of_day,
             int(minutes % minutes_of_hour), int(seconds % seconds_of_minute),
             int(frame % per_second), drop_frame };
}

} // namespace

bool has_time_codes(FrameRate rate)
{
    const bool whole = rate.denominator == 1;
    const bool ntsc = rate.denominator == 1001 && rate.numerator % 1000 == 0;
    return (whole || ntsc) && rounded_up(rate) <= most_frames;
}

TimeCode time_code_from_text(std::string_view text)
{
    const auto digit = [&](std::size_t i) {
        return i < text.size() && text[i] >= '0' && text[i] <= '9' ? text[i] - '0'
                                                                   : 100;
    };
    const auto two = [&](std::size_t i) { return 10 * digit(i) + digit(i + 1); };
    const bool separated = text.size() == std::string_view("hh:mm:ss:ff").size()
        && text[2] == ':' && text[5] == ':' && (text[8] == ':' || text[8] == ';');
    if (separated) {
        const TimeCode code { two(0), two(3), two(6), two(9), text[8] == ';' };
        if (is_clock(code) && code.frames < 100)
            return code;
    }
    throw Error("time code \"" + std::string(text)
                + "\" must be hh:mm:ss:ff as in 01:00:00:00, or hh:mm:ss;ff with "
                  "dropped frame numbers");
}

std::optional<TimeCode> time_code_from_packed(std::uint32_t packed,
                                              const std::optional<FrameRate>& rate)
{
    const auto byte = [&](int i) { return packed >> (8 * i) & 0xffu; };
    TimeCode code { digits_of(byte(3), 0x30), digits_of(byte(2), 0x70),
                    digits_of(byte(1), 0x70), digits_of(byte(0), 0x30),
                    (byte(0) & drop_bit) != 0 };
    const bool known = code.hours >= 0 && code.minutes >= 0 && code.seconds >= 0
        && code.frames >= 0 && is_clock(code);
    if (!known)
        return std::nullopt;
    if (in_pairs(rate))
        code.frames = 2 * code.frames + ((byte(mark_byte(rate)) & mark_bit) != 0);
    return code;
}

std::string text_of(const TimeCode& code)
{
    char text[64];
    std::snprintf(text, sizeof text, "%02d:%02d:%02d%c%02d", code.hours, code.minutes,
                  code.seconds, code.drop_frame ? ';' : ':', code.frames);
    return text;
}

void check(const TimeCode& code, FrameRate rate)
{
    const std::string start = "time code " + text_of(code);
    const int frames = counted(rate);
    if (!is_clock(code) || code.frames >= frames)
        throw Error(start + " is none at " + text_of(rate)
                    + " frames a second, which counts them from 0 to "
                    + std::to_string(frames - 1));
    if (!code.drop_frame)
        return;
    if (!may_drop(rate))
        throw Error(
            start
            + " drops frame numbers, as only 29.97 and 59.94 frames a second "
              "do, and the rate is "
            + text_of(rate) + ": write it "
            + text_of({ code.hours, code.minutes, code.seconds, code.frames, false }));
    if (code.seconds == 0 && code.minutes % 10 != 0 && code.frames < dropped(rate))
        throw Error(start + " is one of the numbers that are dropped: the first is "
                    + text_of({ code.hours, code.minutes, 0, dropped(rate), true }));
}

TimeCode advanced(const TimeCode& first, FrameRate rate, std::uint64_t frames)
{
    check(first, rate);
    const TimeCode last { hours_of_day - 1, 59, 59, counted(rate) - 1,
                          first.drop_frame };
    const std::int64_t day = frame_of_day(last, rate) + 1;
    const auto later = std::int64_t(frames % std::uint64_t(day));
    return code_of((frame_of_day(first, rate) + later) % day, rate, first.drop_frame);
}

std::array<std::uint8_t, 8> smpte_331m(const TimeCode& code,
                                       const std::optional<FrameRate>& rate)
{
    const bool pairs = in_pairs(rate);
    const int frames = pairs ? code.frames / 2 : code.frames;
    if (frames > most_digits)
        throw Error("time code " + text_of(code)
                    + " has more than 39 frames: say the "
                      "frame rate, by which they are counted in pairs");
    std::array<std::uint8_t, 8> bytes { coded(frames), coded(code.seconds),
                                        coded(code.minutes), coded(code.hours) };
    if (code.drop_frame)
        bytes[0] |= drop_bit;
    if (pairs && code.frames % 2 == 1)
        bytes[std::size_t(mark_byte(rate))] |= mark_bit;
    return bytes;
}

} // namespace cg2raw

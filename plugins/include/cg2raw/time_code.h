// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file When a frame of a shot is seen: frame rates and SMPTE time codes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace cg2raw {

/// Frames per second as a fraction in lowest terms, both above 0.
struct FrameRate {
    std::int32_t numerator, denominator;

    bool operator==(const FrameRate& other) const
    {
        return numerator == other.numerator && denominator == other.denominator;
    }
};

/// "24", "24000/1001", or a decimal number: 23.976 (or 23.98), 29.97, 47.952, 59.94 and
/// their like are N x 1000/1001, others are taken to three decimals. Throws Error below
/// 0.001 or above 10000 frames per second.
FrameRate frame_rate_from_text(std::string_view text);
/// "24" or "24000/1001".
std::string text_of(FrameRate rate);

/// The number of a frame in hours, minutes, seconds and frames. Frames are counted from
/// 0 to the rate rounded up, also above 30 frames per second. Source: SMPTE ST 12-1.
struct TimeCode {
    int hours, minutes, seconds, frames;
    bool drop_frame; ///< numbers are left out, to keep up with 29.97 frames per second
};

/// "hh:mm:ss:ff"; with ";" before the frames where numbers are dropped. Throws Error
/// for other texts, and for numbers that no clock shows.
TimeCode time_code_from_text(std::string_view text);
/// What OpenEXR files and OpenImageIO hold: the binary-coded digits of hours, minutes,
/// seconds and frames from the highest byte on, with flags among them. Above 30 frames
/// per second they count pairs of frames. Nothing if the digits are none.
/// Source: OpenEXR, ImfTimeCode.h (TV60 packing); SMPTE ST 12-1:2014, 12.1.
std::optional<TimeCode> time_code_from_packed(std::uint32_t packed,
                                              const std::optional<FrameRate>& rate);
std::string text_of(const TimeCode& code);

/// Whether time codes count the frames of a rate: whole numbers up to 60, and those
/// x 1000/1001.
bool has_time_codes(FrameRate rate);
/// Throws Error if @p code is no time code at @p rate: frames beyond the rate, dropped
/// numbers at a rate other than 29.97 and 59.94 or one of the numbers that are dropped,
/// or a rate without time codes.
void check(const TimeCode& code, FrameRate rate);
/// The time code @p frames after @p first, around midnight. Throws Error as check does.
TimeCode advanced(const TimeCode& first, FrameRate rate, std::uint64_t frames);

/// The 8 bytes of TimeCodes: binary-coded digits of frames, seconds, minutes and hours,
/// then user data, here 0. Above 30 frames per second they count pairs, with the second
/// frame of a pair marked. Throws Error for frames that two digits below 40 cannot say.
/// Source: SMPTE 331M as CinemaDNG 1.1 uses it; SMPTE ST 12-1:2014, 12.1.
std::array<std::uint8_t, 8> smpte_331m(const TimeCode& code,
                                       const std::optional<FrameRate>& rate);

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "dng_tags.h"

#include "cg2raw/types.h"

#include <cmath>
#include <limits>

namespace cg2raw {

namespace {

/// Source: Exif 2.3 (CIPA DC-008-2012), tables 7 and 8.
enum : std::uint32_t {
    exposure_time = 33434,
    f_number = 33437,
    photographic_sensitivity = 34855, // ISOSpeedRatings before 2.3
    sensitivity_type = 34864,
    iso_speed = 34867,
    exif_version = 36864,
    date_time_original = 36867,
    focal_length = 37386,
    lens_model = 42036,
};

constexpr std::uint16_t type_is_iso_speed = 3;
constexpr int largest_short = 65535;

/// Seconds as people know them: 1/125, else whole microseconds.
Rational exposure(double seconds)
{
    const double inverse = std::round(1.0 / seconds);
    if (inverse >= 1.0 && inverse < 1e9 && std::abs(seconds * inverse - 1.0) < 1e-6)
        return { 1, std::uint32_t(inverse) };
    return rational(seconds, seconds < 4000.0 ? 1000000 : 1);
}

/// Exif's field has 16 bits; what exceeds it stands in ISOSpeed.
void add_iso(Tags& tags, int iso)
{
    const int shown = iso < largest_short ? iso : largest_short;
    tags.push_back({ photographic_sensitivity,
                     std::vector<std::uint16_t> { std::uint16_t(shown) } });
    if (iso > largest_short) {
        tags.push_back(
            { sensitivity_type, std::vector<std::uint16_t> { type_is_iso_speed } });
        tags.push_back(
            { iso_speed, std::vector<std::uint32_t> { std::uint32_t(iso) } });
    }
}

template <class Integer> Integer rounded(double value, Integer denominator)
{
    const double numerator = std::round(value * double(denominator));
    if (!(numerator >= double(std::numeric_limits<Integer>::min())
          && numerator <= double(std::numeric_limits<Integer>::max())))
        throw Error("DNG: " + std::to_string(value) + " does not fit a fraction of "
                    + std::to_string(denominator) + " in 32 bits");
    return Integer(numerator);
}

} // namespace

Rational rational(double value, std::uint32_t denominator)
{
    return { rounded(value, denominator), denominator };
}

SignedRational signed_rational(double value, std::int32_t denominator)
{
    return { rounded(value, denominator), denominator };
}

Tags exif_tags(const Shot& shot)
{
    using Rationals = std::vector<Rational>;
    Tags tags { { exif_version, Undefined { { '0', '2', '3', '0' } } } };
    if (shot.exposure_time)
        tags.push_back({ exposure_time, Rationals { exposure(*shot.exposure_time) } });
    if (shot.f_number)
        tags.push_back({ f_number, Rationals { rational(*shot.f_number, 100) } });
    if (shot.focal_length)
        tags.push_back(
            { focal_length, Rationals { rational(*shot.focal_length, 100) } });
    if (shot.iso)
        add_iso(tags, *shot.iso);
    if (!shot.date_time_original.empty())
        tags.push_back({ date_time_original, shot.date_time_original });
    if (!shot.lens_model.empty())
        tags.push_back({ lens_model, shot.lens_model });
    return tags;
}

} // namespace cg2raw

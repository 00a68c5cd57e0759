// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "writer/tags.h"

#include <cmath>

namespace cg2raw {

namespace {

/// Source: Exif 2.3 (CIPA DC-008-2012), table 8.
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
    tags.push_back({ tag::iso_speed_ratings,
                     std::vector<std::uint16_t> { std::uint16_t(shown) } });
    if (iso > largest_short) {
        tags.push_back({ tag::sensitivity_type,
                         std::vector<std::uint16_t> { type_is_iso_speed } });
        tags.push_back(
            { tag::iso_speed, std::vector<std::uint32_t> { std::uint32_t(iso) } });
    }
}

} // namespace

Tags exif_tags(const Shot& shot)
{
    using Rationals = std::vector<Rational>;
    using SignedRationals = std::vector<SignedRational>;
    Tags tags { { tag::exif_version, Undefined { { '0', '2', '3', '0' } } } };
    if (shot.exposure_time)
        tags.push_back(
            { tag::exposure_time, Rationals { exposure(*shot.exposure_time) } });
    if (shot.f_number)
        tags.push_back({ tag::f_number, Rationals { rational(*shot.f_number, 100) } });
    if (shot.focal_length)
        tags.push_back(
            { tag::focal_length, Rationals { rational(*shot.focal_length, 100) } });
    if (shot.iso)
        add_iso(tags, *shot.iso);
    const auto add_stops = [&](TiffTag tag, const std::optional<double>& stops) {
        if (stops)
            tags.push_back({ tag, SignedRationals { signed_rational(*stops, 100) } });
    };
    add_stops(tag::brightness_value, shot.brightness);
    add_stops(tag::exposure_bias_value, shot.exposure_bias);
    if (shot.exposure_mode)
        tags.push_back(
            { tag::exposure_mode,
              std::vector<std::uint16_t> { std::uint16_t(*shot.exposure_mode) } });
    if (!shot.date_time_original.empty())
        tags.push_back({ tag::date_time_original, shot.date_time_original });
    if (!shot.lens_model.empty())
        tags.push_back({ tag::lens_model, shot.lens_model });
    return tags;
}

} // namespace cg2raw

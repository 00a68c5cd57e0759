// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "writer/tags.h"

#include <algorithm>
#include <cmath>

namespace cg2raw {

namespace {

constexpr int smallest_side = 2;
constexpr int largest_side = 65535;
constexpr int largest_dn = 65535;

/// One fact of a description: @p holds, or Error with what is there and what must be.
class Checker {
public:
    explicit Checker(const std::string& path)
        : m_path(path)
    {
    }

    template <class Value>
    void need(bool holds, const char* field, const Value& value,
              const std::string& bound) const
    {
        if (!holds)
            throw Error(m_path + ": " + field + " is " + text(value) + ", but must be "
                        + bound);
    }

private:
    static std::string text(const std::string& value) { return value; }
    template <class Number> static std::string text(const Number& value)
    {
        return std::to_string(value);
    }

    const std::string& m_path;
};

void check_size(const Checker& checker, const DngDescription& description)
{
    const CfaPattern& cfa = description.cfa;
    const auto legal = [](int side, int repeat) {
        return side >= std::max(smallest_side, repeat) && side <= largest_side;
    };
    checker.need(cfa.width >= 1 && cfa.height >= 1 && cfa.sites() <= 36, "cfa",
                 std::to_string(cfa.width) + " x " + std::to_string(cfa.height),
                 "1 to 36 sites");
    for (int color = 0; color < 3 && !cfa.is_mono(); ++color)
        checker.need(
            std::count(cfa.colors.begin(), cfa.colors.begin() + cfa.sites(), color) > 0,
            "cfa", "without colour " + std::to_string(color), "of R, G and B");
    const auto bound = [](int repeat) {
        return repeat >= smallest_side
            ? "one repeat of the CFA (" + std::to_string(repeat) + ") to 65535 pixels"
            : std::to_string(smallest_side) + " to 65535 pixels";
    };
    checker.need(legal(description.size.width, cfa.width), "width",
                 description.size.width, bound(cfa.width));
    checker.need(legal(description.size.height, cfa.height), "height",
                 description.size.height, bound(cfa.height));
}

void check_levels(const Checker& checker, const DngDescription& description)
{
    checker.need(description.white_level > 0 && description.white_level <= largest_dn,
                 "white_level", description.white_level, "1 to 65535 DN");
    checker.need(int(description.black_level.size()) == description.cfa.sites(),
                 "black_level",
                 std::to_string(description.black_level.size()) + " numbers",
                 "one per CFA site");
    for (const double black : description.black_level)
        checker.need(black >= 0.0 && black < description.white_level, "black_level",
                     black, "at least 0 and below white_level");
}

void check_color(const Checker& checker, const DngDescription& description)
{
    const std::size_t count = description.calibrations.size();
    if (description.cfa.is_mono()) {
        checker.need(count == 0, "calibrations", std::to_string(count) + " matrices",
                     "none of a monochrome sensor");
        return;
    }
    checker.need(count == 1 || count == 2, "calibrations",
                 std::to_string(count) + " matrices", "one or two");
    for (const Calibration& calibration : description.calibrations)
        for (const double m : calibration.camera_from_xyz.m)
            checker.need(std::abs(m) < 200.0, "camera_from_xyz", m, "within +-200");
    for (const double channel : description.as_shot_neutral)
        checker.need(channel >= 1e-3 && channel <= 1000.0, "as_shot_neutral", channel,
                     "0.001 to 1000, green 1");
}

void check_noise(const Checker& checker, const DngDescription& description)
{
    const std::size_t count = description.noise_profile.size();
    const std::size_t planes = description.cfa.is_mono() ? 1 : 3;
    checker.need(count == 0 || count == planes, "noise_profile",
                 std::to_string(count) + " pairs", "none or one per colour");
    for (const NoisePair& pair : description.noise_profile) {
        checker.need(pair.scale > 0.0 && std::isfinite(pair.scale),
                     "noise_profile scale", pair.scale, "above 0");
        checker.need(pair.offset >= 0.0 && std::isfinite(pair.offset),
                     "noise_profile offset", pair.offset, "at least 0");
    }
}

void check_shot(const Checker& checker, const Shot& shot)
{
    const auto positive = [&](const std::optional<double>& value, const char* field) {
        if (value)
            checker.need(*value > 0.0 && *value <= 1e6, field, *value,
                         "above 0, up to 1000000");
    };
    positive(shot.exposure_time, "exposure_time");
    positive(shot.f_number, "f_number");
    positive(shot.focal_length, "focal_length");
    for (const auto& [stops, field] : { std::pair(shot.exposure_bias, "exposure_bias"),
                                        std::pair(shot.brightness, "brightness") })
        if (stops)
            checker.need(std::abs(*stops) <= most_exif_stops, field, *stops,
                         "-10000 to 10000");
    if (shot.iso)
        checker.need(*shot.iso > 0, "iso", *shot.iso, "above 0");
    checker.need(shot.orientation >= 1 && shot.orientation <= 8, "orientation",
                 shot.orientation, "1 to 8");
    if (shot.pixel_aspect)
        checker.need(*shot.pixel_aspect >= least_pixel_aspect
                         && *shot.pixel_aspect <= most_pixel_aspect,
                     "pixel_aspect", *shot.pixel_aspect, "0.01 to 100");
    if (shot.frame_rate)
        checker.need(shot.frame_rate->numerator > 0 && shot.frame_rate->denominator > 0,
                     "frame_rate", text_of(*shot.frame_rate), "above 0");
    // libtiff keeps 20 bytes for it, with the final 0.
    checker.need(shot.date_time_original.empty()
                     || shot.date_time_original.size() == 19,
                 "date_time_original", shot.date_time_original, "YYYY:MM:DD HH:MM:SS");
}

/// A time code counts the frames of the rate.
void check_time_code(const std::string& path, const Shot& shot)
{
    if (!shot.time_code || !shot.frame_rate)
        return;
    try {
        check(*shot.time_code, *shot.frame_rate);
    } catch (const Error& error) {
        throw Error(path + ": " + error.what());
    }
}

} // namespace

void check(const DngDescription& description, const std::string& path)
{
    const Checker checker(path);
    check_size(checker, description);
    check_levels(checker, description);
    check_color(checker, description);
    check_noise(checker, description);
    check_shot(checker, description.shot);
    check_time_code(path, description.shot);
}

} // namespace cg2raw

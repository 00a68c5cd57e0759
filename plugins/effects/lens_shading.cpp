// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Fall-off of the lens: a polynomial of the place. Of a round lens it is even in
/// the radius, with a tilt if its centre is off; maps of real cameras need all powers
/// up to the sixth. DNG carries its inverse as a GainMap.
#include "lens_shading.h"

#include "plane_rows.h"

#include <algorithm>

namespace cg2raw {
namespace {

/// A term of a lens that is not round: r^power times the cosine, or the sine, of angles
/// times the angle from the right, downwards.
struct Irregular {
    std::size_t power, angles;
};

constexpr std::array<Irregular, 10> irregular { {
    { 2, 2 },
    { 3, 3 },
    { 4, 2 },
    { 4, 4 },
    { 5, 1 },
    { 5, 3 },
    { 5, 5 },
    { 6, 2 },
    { 6, 4 },
    { 6, 6 },
} };
constexpr std::size_t highest_power = 6;
static_assert(lens_shading_size == round_lens_shading_size + 2 * irregular.size());

double round_gain(const Values& values, double u, double v)
{
    const double square = u * u + v * v;
    const double radial
        = 1.0 + square * (values[0] + square * (values[1] + square * values[2]));
    const double tilt = values[3] * u + values[4] * v;
    return radial + tilt + square * (values[5] * u + values[6] * v);
}

/// The values without zeros at their end that a lens which is round does not need.
Values needed(Values values)
{
    const auto first = values.begin() + round_lens_shading_size;
    if (std::all_of(first, values.end(), [](double value) { return value == 0.0; }))
        values.resize(round_lens_shading_size);
    return values;
}

} // namespace

std::array<double, lens_shading_size> lens_shading_terms(double u, double v)
{
    const double square = u * u + v * v;
    std::array<double, lens_shading_size> terms {
        square, square * square, square * square * square, u, v, square * u, square * v
    };
    // (u + i v)^n = r^n (cosine + i sine of n times the angle)
    std::array<double, highest_power + 1> cosine { 1.0 }, sine { 0.0 };
    for (std::size_t n = 1; n <= highest_power; ++n) {
        cosine[n] = cosine[n - 1] * u - sine[n - 1] * v;
        sine[n] = cosine[n - 1] * v + sine[n - 1] * u;
    }
    for (std::size_t i = 0; i < irregular.size(); ++i) {
        const auto [power, angles] = irregular[i];
        double radial = 1.0;
        for (std::size_t n = angles; n < power; n += 2)
            radial *= square;
        terms[round_lens_shading_size + 2 * i] = radial * cosine[angles];
        terms[round_lens_shading_size + 2 * i + 1] = radial * sine[angles];
    }
    return terms;
}

double lens_shading_at(const Values& values, double u, double v)
{
    double gain = round_gain(values, u, v);
    if (values.size() > round_lens_shading_size) {
        const auto terms = lens_shading_terms(u, v);
        for (std::size_t i = round_lens_shading_size; i < values.size(); ++i)
            gain += values[i] * terms[i];
    }
    return std::max(0.0, gain);
}

namespace effects {
namespace {

void predict(Signal& signal, const Values& given)
{
    const Values values = needed(given);
    each_field_row(signal, [&](int row, const double* u, double v) {
        for (int col = 0; col < signal.mean[0].width; ++col) {
            const float gain = float(lens_shading_at(values, u[col], v));
            for (int plane = 0; plane < signal.planes; ++plane)
                signal.mean[std::size_t(plane)].row(row)[col] *= gain;
        }
    });
}

std::vector<Parameter> parameters()
{
    std::vector<Parameter> all {
        { "r2", "1", -8.0, 8.0, 0.0, "of r^2; r = 1 in the corner" },
        { "r4", "1", -8.0, 8.0, 0.0, "of r^4" },
        { "r6", "1", -8.0, 8.0, 0.0, "of r^6" },
        { "tilt_x", "1", -1.0, 1.0, 0.0, "linear, to the right, per half diagonal" },
        { "tilt_y", "1", -1.0, 1.0, 0.0, "linear, downwards, per half diagonal" },
        { "tilt_x_r2", "1", -2.0, 2.0, 0.0, "of r^2 times the way to the right" },
        { "tilt_y_r2", "1", -2.0, 2.0, 0.0, "of r^2 times the way downwards" },
    };
    for (const auto& [power, angles] : irregular) {
        const std::string radius = "r" + std::to_string(power);
        const std::string of = "of r^" + std::to_string(power) + " times the ";
        const std::string times = std::to_string(angles);
        for (const std::string wave : { "cos", "sin" }) {
            Parameter one { radius + "_" + wave + times, "1", -4.0, 4.0, 0.0, "" };
            one.meaning = of + (wave == "cos" ? "cosine" : "sine") + " of "
                + (angles == 1 ? "" : times + " times ")
                + "the angle from the right, downwards";
            one.optional = true;
            all.push_back(one);
        }
    }
    return all;
}

} // namespace

Effect lens_shading()
{
    return {
        "lens_shading",
        Stage::optics,
        Pattern::none,
        parameters(),
        "vignetting: loss of illumination towards the corners",
        "D. B. Goldman, IEEE Trans. PAMI 32(12), 2010 (even polynomial); the tilt: "
        "first and third order of a shift of its centre; the rest: all other powers of "
        "the place up to the sixth, for a lens that is not round",
        predict
    };
}

} // namespace effects
} // namespace cg2raw

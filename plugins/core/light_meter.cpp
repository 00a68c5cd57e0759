// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The light meter: a percentile of a scene's luminance, by a histogram whose
/// bins are 1/256 of an octave, so that any order of the pixels gives the same number.
#include "cg2raw/light_meter.h"

#include "cg2raw/color.h"
#include "cg2raw/exposure.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <mutex>
#include <numeric>

namespace cg2raw {
namespace {

constexpr int bin_bits = 8; ///< of the mantissa
constexpr int float_mantissa = 23, float_bias = 127;
/// Octaves below and above 1 that bins cover; what is outside counts as their ends.
constexpr int octaves_below = 40, octaves_above = 24;
constexpr int bins = (octaves_below + octaves_above) << bin_bits;
constexpr int first_code = (float_bias - octaves_below) << bin_bits;

using Histogram = std::vector<std::int64_t>;

int bin_of(float luminance)
{
    std::int32_t bits = 0;
    std::memcpy(&bits, &luminance, sizeof bits);
    return std::clamp((bits >> (float_mantissa - bin_bits)) - first_code, 0, bins - 1);
}

/// The middle of a bin.
double luminance_of(int bin)
{
    const std::int32_t half = 1 << (float_mantissa - bin_bits - 1);
    const std::int32_t bits
        = ((first_code + bin) << (float_mantissa - bin_bits)) + half;
    float luminance = 0.0f;
    std::memcpy(&luminance, &bits, sizeof luminance);
    return double(luminance);
}

/// Of the Rec.709 luminance, for scene pixels or for those that a sensor's channels
/// saw: there white is the light's neutral.
std::array<float, 3> weights_of(const SensorProfile& profile, const Run& run)
{
    const Mat3 xyz = xyz_d65_from_srgb();
    const double white = xyz(1, 0) + xyz(1, 1) + xyz(1, 2);
    Vec3 neutral { 1.0, 1.0, 1.0 };
    if (run.camera_input && !profile.cfa.is_mono())
        neutral = illuminant(profile, run.illuminant, run.as_shot).neutral;
    const double largest = *std::max_element(neutral.begin(), neutral.end());
    std::array<float, 3> weights {};
    for (int i = 0; i < 3; ++i)
        weights[std::size_t(i)]
            = float(xyz(1, i) / white * largest / neutral[std::size_t(i)]);
    return weights;
}

void count(const RgbView& scene, const std::array<float, 3>& weight, Histogram& counts)
{
    for (int row = 0; row < scene.height; ++row) {
        const float* pixel = scene.row(row);
        for (int col = 0; col < scene.width; ++col, pixel += scene.pixel_stride) {
            const float luminance
                = weight[0] * pixel[0] + weight[1] * pixel[1] + weight[2] * pixel[2];
            if (luminance > 0.0f && std::isfinite(luminance))
                ++counts[std::size_t(bin_of(luminance))];
        }
    }
}

/// Pixels up to the end of each bin, and what their percentiles are.
class Distribution {
public:
    explicit Distribution(const Histogram& counts)
    {
        std::partial_sum(counts.begin(), counts.end(), std::back_inserter(m_up_to));
    }

    std::int64_t pixels() const { return m_up_to.back(); }
    std::int64_t pixels_up_to(double luminance) const
    {
        return m_up_to[std::size_t(bin_of(float(luminance)))];
    }
    /// Of the darkest @p pixels, at least one.
    double percentile(double percent, std::int64_t pixels) const
    {
        const auto rank = std::max<std::int64_t>(
            1, std::int64_t(std::ceil(double(pixels) * percent / 100.0)));
        const auto found = std::lower_bound(m_up_to.begin(), m_up_to.end(), rank);
        return luminance_of(int(found - m_up_to.begin()));
    }

private:
    std::vector<std::int64_t> m_up_to;
};

/// How many of the darkest pixels are no lamps: lamps, and what mirrors them, are
/// brighter than three times the upper quartile of what is left without them, and cover
/// a quarter of the picture at most.
std::int64_t without_lamps(const Distribution& scene)
{
    constexpr double quartile = 75.0, lamp = 3.0;
    std::int64_t pixels = scene.pixels();
    const std::int64_t least = pixels - pixels / 4;
    while (true) {
        const std::int64_t kept = std::max(
            scene.pixels_up_to(lamp * scene.percentile(quartile, pixels)), least);
        if (kept >= pixels)
            return pixels;
        pixels = kept;
    }
}

} // namespace

Run metered(const SensorProfile& profile, Run run, Size frame, const SceneRows& rows,
            const ParallelFor& parallel)
{
    if (!needs_meter(run) || run.meter)
        return run;
    const std::array<float, 3> weights = weights_of(profile, run);
    Histogram total(std::size_t(bins), 0);
    std::mutex guard;
    each_strip(rows, frame, parallel, [&](const RgbView& part, int, Illegal&) {
        Histogram counts(std::size_t(bins), 0);
        count(part, weights, counts);
        const std::lock_guard lock(guard);
        for (std::size_t bin = 0; bin < total.size(); ++bin)
            total[bin] += counts[bin];
    });
    const Distribution scene(total);
    // A level of captures is that of all of a frame.
    const bool lamps_count = run.exposure->kind == ExposureRule::Kind::matched;
    run.meter = scene.pixels() == 0
        ? 0.0
        : scene.percentile(run.exposure->first,
                           lamps_count ? scene.pixels() : without_lamps(scene));
    return run;
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/spectral_image.h"

#include "illuminant_daylight_tables.h"
#include "illuminant_spec.h"
#include "illuminant_spectrum.h"
#include "multiversion.h"
#include "text.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace cg2raw {
namespace {

/// Luminous efficacy of 555 nm, lm/W. Source: BIPM, The International System of Units.
constexpr double luminous_efficacy = 683.0;
constexpr double least_white = 1e-6, most_white = 1e12; // cd/m2

/// Boundaries of boxes around @p centres: half way to the neighbours, and as far beyond
/// the ends.
std::vector<double> box_edges(const std::vector<double>& centres)
{
    std::vector<double> edges { 1.5 * centres[0] - 0.5 * centres[1] };
    for (std::size_t i = 1; i < centres.size(); ++i)
        edges.push_back(0.5 * (centres[i - 1] + centres[i]));
    const std::size_t last = centres.size() - 1;
    edges.push_back(1.5 * centres[last] - 0.5 * centres[last - 1]);
    return edges;
}

/// What the channels see of a radiance of 1 between two wavelengths.
Vec3 seen_between(const SpectralSensitivities& sensitivities, double from, double to)
{
    Vec3 result;
    for (std::size_t c = 0; c < 3; ++c)
        result[c] = integral([&](double nm) { return sensitivities.at(nm)[c]; },
                             sensitivities.wavelengths, from, to);
    return result;
}

/// cd/m2 of a radiance in W/(m2 sr nm).
double luminance_of(const Spectrum& radiance)
{
    const Spectrum luminosity { table_wavelengths(),
                                { luminous.begin(), luminous.end() } };
    const std::vector<double> nodes
        = merged(luminosity.wavelengths, radiance.wavelengths);
    return luminous_efficacy
        * integral([&](double nm) { return luminosity.at(nm) * radiance.at(nm); },
                   nodes, visible_from, visible_to);
}

/// What makes 1 of the channel that sees most of white.
double over_white(const SensorProfile& profile, const Illuminant& light, double white)
{
    if (!(white >= least_white && white <= most_white))
        throw Error("luminance of white " + number(white) + " cd/m2 must be "
                    + number(least_white) + " to " + number(most_white));
    const Spectrum power = spectrum_of(profile, light).power;
    const double seen = max_of(response(*profile.spectral_sensitivities, power));
    return luminance_of(power) / (white * seen);
}

/// Sums over bins of one pixel: R, G, B, and a fourth that makes it a register.
using Sums = float __attribute__((vector_size(4 * sizeof(float))));

Sums sums_of(const std::array<float, 4>& values)
{
    Sums sums;
    std::memcpy(&sums, values.data(), sizeof(sums));
    return sums;
}

void put(const Sums& sums, float* rgb)
{
    for (int c = 0; c < 3; ++c)
        rgb[c] = sums[c];
}

/// Pixels whose sums do not wait for each other. Each adds its bins in their order.
constexpr int at_once = 4;

CG2RAW_MULTIVERSION void add_bins(const float* pixels, std::ptrdiff_t pixel_stride,
                                  int width, const int* channels,
                                  const std::array<float, 4>* weights,
                                  std::size_t count, float* rgb)
{
    int first = 0;
    for (; first + at_once <= width; first += at_once) {
        const float* const a = pixels + first * pixel_stride;
        const float* const b = a + pixel_stride;
        const float* const c = b + pixel_stride;
        const float* const d = c + pixel_stride;
        Sums of_a {}, of_b {}, of_c {}, of_d {};
        for (std::size_t bin = 0; bin < count; ++bin) {
            const Sums weight = sums_of(weights[bin]);
            const int channel = channels[bin];
            of_a += weight * a[channel];
            of_b += weight * b[channel];
            of_c += weight * c[channel];
            of_d += weight * d[channel];
        }
        float* const to = rgb + 3 * std::ptrdiff_t(first);
        put(of_a, to);
        put(of_b, to + 3);
        put(of_c, to + 6);
        put(of_d, to + 9);
    }
    for (; first < width; ++first) {
        Sums sums {};
        for (std::size_t bin = 0; bin < count; ++bin)
            sums
                += sums_of(weights[bin]) * pixels[first * pixel_stride + channels[bin]];
        put(sums, rgb + 3 * std::ptrdiff_t(first));
    }
}

} // namespace

SpectralResponse::SpectralResponse(const SensorProfile& profile,
                                   const Illuminant& light,
                                   const SpectralChannels& bins, double white)
    : m_channels(bins.channels)
{
    const double scale = over_white(profile, light, white);
    const std::vector<double> edges = box_edges(bins.wavelengths);
    double most = 0.0;
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
        Vec3 seen
            = seen_between(*profile.spectral_sensitivities, edges[i], edges[i + 1]);
        for (double& value : seen)
            value *= scale;
        most = std::max(most, max_of(seen));
        m_per_bin.push_back(seen);
        m_weights.push_back({ float(seen[0]), float(seen[1]), float(seen[2]), 0.0f });
    }
    if (!(most > 0.0))
        throw Error("sensor " + profile.id + " sees nothing of "
                    + number(bins.wavelengths.front()) + " to "
                    + number(bins.wavelengths.back()) + " nm, the image's spectrum");
}

void SpectralResponse::to_camera(const float* pixels, std::ptrdiff_t pixel_stride,
                                 int width, float* rgb) const
{
    add_bins(pixels, pixel_stride, width, m_channels.data(), m_weights.data(),
             m_channels.size(), rgb);
}

std::string seen_by_sensitivities(const SensorProfile& profile, const std::string& spec)
{
    using Kind = IlluminantSpec::Kind;
    if (!profile.spectral_sensitivities || profile.cfa.is_mono()
        || lamp_named(profile.lamps, spec))
        return spec;
    const Kind kind = parse_illuminant(spec).kind;
    const bool names_chromaticity = lower_case(spec).rfind("xy:", 0) == 0;
    if (names_chromaticity || (kind != Kind::xy && kind != Kind::kelvin))
        return spec;
    const Spectrum power = spectrum_of(profile, illuminant(profile, spec)).power;
    const Vec3 neutral = over_green(response(*profile.spectral_sensitivities, power));
    return "neutral:" + number(neutral[0]) + ":" + number(neutral[2]);
}

} // namespace cg2raw

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
#include <numeric>

namespace cg2raw {
namespace {

/// Luminous efficacy of 555 nm, lm/W. Source: BIPM, The International System of Units.
constexpr double luminous_efficacy = 683.0;
constexpr std::size_t most_nodes
    = 20000; ///< of responses; more would be no measurement
constexpr double least_white = 1e-6, most_white = 1e12; // cd/m2

void require_sensitivities(const SensorProfile& profile)
{
    if (!profile.spectral_sensitivities)
        throw Error("sensor " + profile.id
                    + " has no spectral_sensitivities: make a profile with cg2raw "
                      "profile --ssf");
}

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

/// Of one bin: what the channels see of a radiance of 1, and widths().
struct Bin {
    Vec3 seen {};
    std::array<double, 2> width {};
};

/// Bins that are boxes from edge to edge.
std::vector<Bin> boxes(const SpectralSensitivities& sensitivities,
                       const std::vector<double>& edges)
{
    const auto& nm = sensitivities.wavelengths;
    std::vector<Bin> bins(edges.size() - 1);
    for (std::size_t i = 0; i < bins.size(); ++i) {
        const double from = edges[i], to = edges[i + 1];
        for (const auto& [wavelength, weight] : quadrature(nm, from, to))
            for (std::size_t c = 0; c < 3; ++c)
                bins[i].seen[c] += weight * sensitivities.at(wavelength)[c];
        const double reached = std::min(to, nm.back()) - std::max(from, nm.front());
        bins[i].width = { to - from, std::max(reached, 0.0) };
    }
    return bins;
}

/// Bins that share out each wavelength by their responses.
std::vector<Bin> shared_out(const SpectralSensitivities& sensitivities,
                            const std::vector<Spectrum>& responses)
{
    const auto& nm = sensitivities.wavelengths;
    std::vector<double> nodes = nm;
    for (const Spectrum& response : responses) {
        nodes = merged(nodes, response.wavelengths);
        if (nodes.size() > most_nodes)
            throw Error("responses of the channels have more than "
                        + number(double(most_nodes))
                        + " wavelengths in all: state them in fewer steps");
    }
    std::vector<Bin> bins(responses.size());
    std::vector<double> shares(responses.size());
    for (const auto& [wavelength, weight] :
         quadrature(nodes, nodes.front(), nodes.back())) {
        double sum = 0.0;
        for (std::size_t i = 0; i < bins.size(); ++i)
            sum += shares[i] = responses[i].at(wavelength);
        if (!(sum > 0.0))
            continue;
        const bool is_reached = wavelength >= nm.front() && wavelength <= nm.back();
        const Vec3 sensitivity = sensitivities.at(wavelength);
        for (std::size_t i = 0; i < bins.size(); ++i) {
            const double share = weight * shares[i] / sum;
            for (std::size_t c = 0; c < 3; ++c)
                bins[i].seen[c] += share * sensitivity[c];
            bins[i].width[0] += share;
            bins[i].width[1] += is_reached ? share : 0.0;
        }
    }
    return bins;
}

/// cd/m2 of a radiance in W/(m2 sr nm).
double luminance_of(const Spectrum& radiance)
{
    const Spectrum luminosity { table_wavelengths(),
                                { luminous.begin(), luminous.end() } };
    const std::vector<double> nodes
        = merged(luminosity.wavelengths, radiance.wavelengths);
    double sum = 0.0;
    for (const auto& [nm, weight] : quadrature(nodes, visible_from, visible_to))
        sum += weight * luminosity.at(nm) * radiance.at(nm);
    return luminous_efficacy * sum;
}

/// What makes 1 of the channel that sees most of white.
double over_white(const SensorProfile& profile, const Spectrum& light, double white)
{
    if (!(white >= least_white && white <= most_white))
        throw Error("luminance of white " + number(white) + " cd/m2 must be "
                    + number(least_white) + " to " + number(most_white));
    const double seen = max_of(response(*profile.spectral_sensitivities, light));
    const double luminance = luminance_of(light);
    if (!(luminance > 0.0))
        throw Error("the light has no luminance: nothing of it is visible");
    return luminance / (white * seen);
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

SpectralResponse::SpectralResponse(const SensorProfile& profile, const Spectrum& light,
                                   const SpectralChannels& bins, double white)
    : m_channels(bins.channels)
{
    require_sensitivities(profile);
    const double scale = over_white(profile, light, white);
    const SpectralSensitivities& sensitivities = *profile.spectral_sensitivities;
    const auto found = bins.responses.empty()
        ? boxes(sensitivities, box_edges(bins.wavelengths))
        : shared_out(sensitivities, bins.responses);
    double most = 0.0;
    for (auto [seen, width] : found) {
        for (double& value : seen)
            value *= scale;
        most = std::max(most, max_of(seen));
        m_per_bin.push_back(seen);
        m_widths.push_back(width);
        m_weights.push_back({ float(seen[0]), float(seen[1]), float(seen[2]), 0.0f });
    }
    if (!(most > 0.0))
        throw Error("sensor " + profile.id + " sees nothing of "
                    + number(bins.wavelengths.front()) + " to "
                    + number(bins.wavelengths.back()) + " nm, the image's spectrum");
}

SpectralResponse SpectralResponse::of_bins_alone() const
{
    SpectralResponse alone = *this;
    std::iota(alone.m_channels.begin(), alone.m_channels.end(), 0);
    return alone;
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
    return neutral_word(profile, spectrum_of(profile, illuminant(profile, spec)).power);
}

std::string neutral_word(const SensorProfile& profile, const Spectrum& light)
{
    require_sensitivities(profile);
    const Vec3 neutral = over_green(response(*profile.spectral_sensitivities, light));
    return "neutral:" + number(neutral[0]) + ":" + number(neutral[2]);
}

} // namespace cg2raw

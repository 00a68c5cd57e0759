// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Draw an illuminant. Source: Seo et al., Graphics2RAW, ICCV 2023, eq. 2-3; of
/// measured neutrals: N. V. Chawla et al., SMOTE, JAIR 16, 2002, section 4.2.
#include "illuminant_spec.h"

#include "cg2raw/random.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace cg2raw {
namespace {

using Point = std::array<double, 2>;

/// A hull takes less than one in this many draws of its own Gaussian only if it is a
/// sliver.
constexpr std::uint32_t most_draws = 100000;
/// Of a neutral's nearest ones, those that a draw may lean to.
constexpr std::size_t nearest = 5;

double at_precision(double value) { return std::round(value * 1e6) / 1e6; }

bool inside(const std::vector<Point>& hull, const Point& p)
{
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const Point &a = hull[i], &b = hull[(i + 1) % hull.size()];
        if ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) < 0.0)
            return false;
    }
    return true;
}

/// The @p draw-th point of a Gaussian.
Point gaussian_point(const Point& mean, const std::array<double, 3>& covariance,
                     const Rng& rng, std::uint32_t draw)
{
    const auto& [rr, rb, bb] = covariance;
    const double l00 = std::sqrt(rr), l10 = l00 > 0.0 ? rb / l00 : 0.0;
    const double l11 = std::sqrt(std::max(0.0, bb - l10 * l10));
    const double z0 = rng.normal(2 * draw), z1 = rng.normal(2 * draw + 1);
    return { at_precision(mean[0] + l00 * z0),
             at_precision(mean[1] + l10 * z0 + l11 * z1) };
}

/// The first of @p point(0), @p point(1) ... inside the hull of the sensor's neutrals.
template <typename PointOfDraw>
Point first_inside_hull(const SensorProfile& profile, const PointOfDraw& point)
{
    for (std::uint32_t draw = 0; draw < most_draws; ++draw)
        if (const Point found = point(draw); inside(profile.illuminants.hull, found))
            return found;
    throw Error("sensor " + profile.id
                + ": no draw of its illuminants falls inside their "
                  "hull; name an illuminant instead of sample");
}

Point sampled_from_gaussian(const SensorProfile& profile, const Rng& rng)
{
    const NeutralDistribution& lights = profile.illuminants;
    return first_inside_hull(profile, [&](std::uint32_t draw) {
        return gaussian_point(lights.mean, lights.covariance, rng, draw);
    });
}

/// Each draw chooses one of the Gaussians by their weights.
Point sampled_from_mixture(const SensorProfile& profile, const Rng& rng)
{
    const auto& mixture = profile.illuminants.mixture;
    const Rng choice = rng.other("Gaussian of a mixture");
    return first_inside_hull(profile, [&](std::uint32_t draw) {
        double left = choice.uniform(draw);
        std::size_t chosen = 0;
        while (chosen + 1 < mixture.size() && left >= mixture[chosen].weight)
            left -= mixture[chosen++].weight;
        return gaussian_point(mixture[chosen].mean, mixture[chosen].covariance, rng,
                              draw);
    });
}

Point sampled_from_locus(const SensorProfile& profile, const Rng& rng)
{
    if (profile.calibrations.size() < 2)
        throw Error(
            "sensor " + profile.id
            + " has fewer than 3 distinct neutrals and one "
              "colour matrix: nothing to sample from; name an illuminant instead");
    const auto mired = [&](std::size_t i) {
        const double kelvin
            = light_source_temperature(profile.calibrations[i].light_source).value;
        return 1e6 / std::clamp(kelvin, 1667.0, 25000.0);
    };
    const double drawn = mired(0) + (mired(1) - mired(0)) * rng.uniform(0);
    const Vec3 neutral = neutral_from_xy(profile, planckian_xy({ 1e6 / drawn }));
    return { neutral[0], neutral[2] };
}

/// The @p rank-th nearest to @p all[of], 0 the nearest; of equals the earlier.
Point neighbour(const std::vector<Point>& all, std::size_t of, std::size_t rank)
{
    std::vector<std::pair<double, std::size_t>> distances;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const double r = all[i][0] - all[of][0], b = all[i][1] - all[of][1];
        if (i != of)
            distances.emplace_back(r * r + b * b, i);
    }
    std::nth_element(distances.begin(), distances.begin() + std::ptrdiff_t(rank),
                     distances.end());
    return all[distances[rank].second];
}

/// Between a neutral and one of its nearest.
Point sampled_near(const std::vector<Point>& known, const Rng& rng)
{
    const auto below = [&](std::uint32_t draw, std::size_t count) {
        return std::min(std::size_t(rng.uniform(draw) * double(count)), count - 1);
    };
    const std::size_t from = below(0, known.size());
    const Point to
        = neighbour(known, from, below(1, std::min(nearest, known.size() - 1)));
    const double share = rng.uniform(2);
    const auto between = [&](std::size_t i) {
        return at_precision(known[from][i] + share * (to[i] - known[from][i]));
    };
    return { between(0), between(1) };
}

} // namespace

Point measured_neutral(const SensorProfile& profile, std::uint32_t index)
{
    const std::vector<Point>& known = profile.illuminants.neutrals;
    const Rng rng(index, "measured illuminant");
    if (known.size() >= 3)
        return sampled_near(known, rng);
    if (!profile.illuminants.mixture.empty())
        return sampled_from_mixture(profile, rng);
    throw Error("sensor " + profile.id + " has "
                + (known.empty() ? "no" : "fewer than 3")
                + " measured neutrals in its profile, nor a mixture of Gaussians that "
                  "stands for them, which measured:N draws of: use sample:N, or make a "
                  "profile of captures of yours by cg2raw profile");
}

Point sampled_neutral(const SensorProfile& profile, std::uint32_t index)
{
    const Rng rng(index, "illuminant");
    return profile.illuminants.hull.size() >= 3 ? sampled_from_gaussian(profile, rng)
                                                : sampled_from_locus(profile, rng);
}

} // namespace cg2raw

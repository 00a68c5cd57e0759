// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "neutral_distribution.h"

#include "text.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cg2raw {
namespace {

/// A draw is compared with each side. Neutrals by the million have a hull of some
/// hundred.
constexpr std::size_t most_hull_points = 1000;

double cross(const std::array<double, 2>& o, const std::array<double, 2>& a,
             const std::array<double, 2>& b)
{
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
}

/// Half a hull: the left turns of points in order (monotone chain).
void append_chain(const std::vector<std::array<double, 2>>& points,
                  std::vector<std::array<double, 2>>& hull)
{
    const std::size_t start = hull.size();
    for (const auto& point : points) {
        while (hull.size() >= start + 2
               && cross(hull[hull.size() - 2], hull.back(), point) <= 0)
            hull.pop_back();
        hull.push_back(point);
    }
    hull.pop_back();
}

std::vector<std::array<double, 2>>
convex_hull(std::vector<std::array<double, 2>> points)
{
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    if (points.size() < 3)
        return {};
    std::vector<std::array<double, 2>> hull;
    append_chain(points, hull);
    std::reverse(points.begin(), points.end());
    append_chain(points, hull);
    return hull.size() < 3 ? std::vector<std::array<double, 2>> {} : hull;
}

[[noreturn]] void fail(const std::string& file, const std::string& what)
{
    throw Error(file + ": illuminants: " + what);
}

void check_pair(const std::string& what, const std::array<double, 2>& pair,
                const std::string& file)
{
    for (double ratio : pair)
        if (!(ratio >= 0.01 && ratio <= 100.0))
            fail(file,
                 what + " " + number(ratio)
                     + " must be within 0.01 to 100 (R/G and B/G)");
}

void check_covariance(const std::string& of, const std::array<double, 3>& covariance,
                      const std::string& file)
{
    const auto& [rr, rb, bb] = covariance;
    if (!(rr >= 0.0 && bb >= 0.0 && rb * rb <= rr * bb * (1 + 1e-9) + 1e-30))
        fail(file, of + "covariance must be positive semi-definite");
}

/// What is said of neutrals that are not listed must be of one set of them: a mean is
/// in their hull, and no variance is above its range squared. Else no draw of the one
/// would fall into the other.
void check_gaussian(const std::string& of, const std::array<double, 2>& mean,
                    const std::array<double, 3>& covariance,
                    const std::vector<std::array<double, 2>>& hull,
                    const std::string& file)
{
    for (std::size_t i = 0; i < hull.size(); ++i)
        if (cross(hull[i], hull[(i + 1) % hull.size()], mean) < 0.0)
            fail(file,
                 of + "mean " + number(mean[0]) + ", " + number(mean[1])
                     + " must lie in the hull, as that of neutrals does");
    for (std::size_t i : { 0, 1 }) {
        const auto [low, high] = std::minmax_element(
            hull.begin(), hull.end(),
            [&](const auto& a, const auto& b) { return a[i] < b[i]; });
        const double range = (*high)[i] - (*low)[i], variance = covariance[2 * i];
        if (!(variance <= range * range))
            fail(file,
                 of + "variance " + number(variance) + " must be at most "
                     + number(range * range) + ", the square of the hull's range");
    }
}

void check_mixture(const NeutralDistribution& lights, const std::string& file)
{
    if (lights.mixture.empty())
        return;
    if (lights.mixture.size() > most_neutral_gaussians)
        fail(file,
             "mixture has " + std::to_string(lights.mixture.size())
                 + " Gaussians; at most " + std::to_string(most_neutral_gaussians));
    double sum = 0.0;
    for (const NeutralGaussian& gaussian : lights.mixture) {
        if (!(gaussian.weight > 0.0 && gaussian.weight <= 1.0))
            fail(file,
                 "mixture: weight " + number(gaussian.weight)
                     + " must be above 0 and at most 1");
        sum += gaussian.weight;
        check_pair("mixture: mean", gaussian.mean, file);
        check_covariance("mixture: ", gaussian.covariance, file);
        check_gaussian("mixture: ", gaussian.mean, gaussian.covariance, lights.hull,
                       file);
    }
    if (!(std::abs(sum - 1.0) <= 1e-3))
        fail(file, "mixture: sum of weights " + number(sum) + " must be 1");
}

} // namespace

NeutralDistribution distribution_of(std::vector<std::array<double, 2>> neutrals)
{
    NeutralDistribution result;
    const double count = double(neutrals.size());
    for (const auto& neutral : neutrals)
        for (std::size_t i = 0; i < 2; ++i)
            result.mean[i] += neutral[i] / count;
    for (const auto& neutral : neutrals) {
        const double r = neutral[0] - result.mean[0], b = neutral[1] - result.mean[1];
        if (count > 1) {
            result.covariance[0] += r * r / (count - 1);
            result.covariance[1] += r * b / (count - 1);
            result.covariance[2] += b * b / (count - 1);
        }
    }
    result.hull = convex_hull(neutrals);
    result.neutrals = std::move(neutrals);
    return result;
}

void check_neutrals(const SensorProfile& profile, const std::string& file)
{
    const NeutralDistribution& lights = profile.illuminants;
    for (const auto& neutral : lights.neutrals)
        check_pair("neutral", neutral, file);
    for (const auto& corner : lights.hull)
        check_pair("hull", corner, file);
    if (lights.hull.size() > most_hull_points)
        fail(file,
             "hull has " + std::to_string(lights.hull.size()) + " corners; at most "
                 + std::to_string(most_hull_points) + ": give a coarser one");
    if (!lights.hull.empty())
        check_pair("mean", lights.mean, file);
    if (lights.neutrals.empty() && !lights.hull.empty())
        check_gaussian("", lights.mean, lights.covariance, lights.hull, file);
    check_covariance("", lights.covariance, file);
    check_mixture(lights, file);
    for (const Lamp& lamp : profile.lamps)
        check_pair("lamp " + lamp.name, lamp.neutral, file);
}

} // namespace cg2raw

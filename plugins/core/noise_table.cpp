// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Noise between calibrated ISOs.
#include "cg2raw/profile.h"

#include "text.h"

#include <algorithm>
#include <cmath>

namespace cg2raw {
namespace {

/// How far beyond the calibrated ISOs a straight line in log-log may go: one stop.
constexpr double reach = 2.0;

double log_log(double a, double b, double weight)
{
    if (a > 0.0 && b > 0.0)
        return std::exp(std::log(a) + weight * (std::log(b) - std::log(a)));
    return std::max(0.0, a + weight * (b - a)); // a measured 0 has no logarithm
}

/// Beyond the rows, and where a 0 was measured, the two curves may cross: noise of rows
/// is a part of all the noise.
NoiseShape shape_between(const NoiseAtIso& a, const NoiseAtIso& b, double weight,
                         const std::vector<double>& beta2)
{
    const double least = *std::min_element(beta2.begin(), beta2.end());
    const double row_sigma = log_log(a.shape->row_sigma, b.shape->row_sigma, weight);
    const double of_b = std::clamp(weight, 0.0, 1.0);
    return { a.shape->tukey_lambda
                 + of_b * (b.shape->tukey_lambda - a.shape->tukey_lambda),
             std::min(row_sigma, std::sqrt(least)) };
}

std::string isos_of(const std::vector<NoiseAtIso>& table)
{
    std::vector<std::string> isos;
    for (const NoiseAtIso& row : table)
        isos.push_back(number(row.iso));
    return joined(isos);
}

} // namespace

NoiseAtIso noise_at(const SensorProfile& profile, double iso)
{
    const auto& table = profile.noise;
    if (table.empty())
        throw Error(
            "sensor " + profile.id
            + " has no measured noise: leave the ISO out, or add \"noise\" to its "
              "profile");
    const double lowest = table.front().iso / reach, highest = table.back().iso * reach;
    if (!(iso >= lowest && iso <= highest))
        throw Error("iso " + number(iso) + " is outside " + number(lowest) + " to "
                    + number(highest) + ", one stop around the ISOs that sensor "
                    + profile.id + " was calibrated at: " + isos_of(table));
    if (table.size() == 1 && iso != table.front().iso)
        throw Error("iso " + number(iso) + ": sensor " + profile.id
                    + " was calibrated at ISO " + number(table.front().iso) + " only");
    const auto above
        = std::find_if(table.begin(), table.end(),
                       [&](const NoiseAtIso& row) { return row.iso >= iso; });
    if (above != table.end() && above->iso == iso)
        return *above;
    const std::size_t second = std::clamp<std::size_t>(
        std::size_t(above - table.begin()), 1, table.size() - 1);
    const NoiseAtIso &a = table[second - 1], &b = table[second];
    const double weight = std::log(iso / a.iso) / std::log(b.iso / a.iso);
    NoiseAtIso result { iso, {}, {} };
    for (std::size_t site = 0; site < a.beta1.size(); ++site) {
        result.beta1.push_back(log_log(a.beta1[site], b.beta1[site], weight));
        result.beta2.push_back(log_log(a.beta2[site], b.beta2[site], weight));
    }
    if (a.shape && b.shape)
        result.shape = shape_between(a, b, weight, result.beta2);
    return result;
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "noise_table.h"

#include "effect_names.h"
#include "elementary.h"
#include "text.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cg2raw {
namespace {

/// How far beyond the calibrated ISOs a straight line in log-log may go: one stop.
constexpr double reach = 2.0;

double log_log(double a, double b, double weight)
{
    if (std::min(a, b) >= std::numeric_limits<double>::min())
        return exponential(natural_log(a) + weight * (natural_log(b) - natural_log(a)));
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
    const auto between
        = [of_b](double of_a, double at_b) { return of_a + of_b * (at_b - of_a); };
    NoiseShape shape { between(a.shape->tukey_lambda, b.shape->tukey_lambda),
                       std::min(row_sigma, std::sqrt(least)) };
    if (a.shape->outliers && b.shape->outliers)
        shape.outliers = Outliers { between(a.shape->outliers->fraction,
                                            b.shape->outliers->fraction),
                                    between(a.shape->outliers->variance_ratio,
                                            b.shape->outliers->variance_ratio) };
    return shape;
}

[[noreturn]] void fail(const std::string& where, const std::string& what)
{
    throw Error(where + ": " + what);
}

void check_within(const char* field, double value, double least, double most,
                  const std::string& at)
{
    if (!(value >= least && value <= most))
        fail(at,
             std::string(field) + " " + number(value) + " must be within "
                 + number(least) + " to " + number(most));
}

/// What some rows of a profile have, the others need.
void check_all_or_none(const char* fields, bool has, bool expected,
                       const std::string& at)
{
    if (has != expected)
        fail(at,
             std::string(fields) + (expected ? " are missing: " : " are given: ")
                 + "all rows of noise need them, or none");
}

void check_shape(const NoiseAtIso& row, const NoiseAtIso& first, const std::string& at)
{
    check_all_or_none("tukey_lambda and row_sigma", row.shape.has_value(),
                      first.shape.has_value(), at);
    if (!row.shape)
        return;
    const auto& [lambda, sigma, outliers] = *row.shape;
    check_within("tukey_lambda", lambda, least_tukey_lambda, most_tukey_lambda, at);
    const double least = *std::min_element(row.beta2.begin(), row.beta2.end());
    if (!(sigma >= 0.0 && sigma * sigma <= least))
        fail(at,
             "row_sigma " + number(sigma) + " must be within 0 to "
                 + number(std::sqrt(least))
                 + ", the root of the least beta2: beta2 is all the noise without "
                   "light, that of rows included");
    check_all_or_none("outlier_fraction and outlier_variance_ratio",
                      outliers.has_value(), first.shape->outliers.has_value(), at);
    if (!outliers)
        return;
    check_within("outlier_fraction", outliers->fraction, 0.0, most_outliers, at);
    check_within("outlier_variance_ratio", outliers->variance_ratio, 1.0,
                 most_outlier_variance_ratio, at);
}

void check_betas(const NoiseAtIso& row, int sites, const std::string& at)
{
    for (const auto* values : { &row.beta1, &row.beta2 }) {
        if (values->size() != std::size_t(sites))
            fail(at,
                 "beta1 and beta2 need " + std::to_string(sites)
                     + " values each, one per CFA site");
        for (double value : *values)
            if (!(value >= 0.0 && value <= 1.0))
                fail(at, number(value) + " must be within 0 to 1");
    }
}

std::string isos_of(const std::vector<NoiseAtIso>& table)
{
    std::vector<std::string> isos;
    for (const NoiseAtIso& row : table)
        isos.push_back(number(row.iso));
    return joined(isos);
}

} // namespace

NoiseEffects noise_effects_from_names(const std::vector<std::string>& names)
{
    for (const std::string& name : names)
        check_effect_name(name);
    const auto one_of = [&](std::size_t i, const char* a, const char* b) {
        return names[i] == a || names[i] == b;
    };
    if (names.size() != 2 || !one_of(0, "shot_noise", "poisson_shot_noise")
        || !one_of(1, "read_noise", "heavy_tailed_noise"))
        throw Error("[" + joined(names)
                    + "] must be shot_noise or poisson_shot_noise, then read_noise or "
                      "heavy_tailed_noise");
    return { names[0], names[1] };
}

void check_noise(const SensorProfile& profile, const std::string& file)
{
    double last_iso = 0.0;
    for (const NoiseAtIso& row : profile.noise) {
        const std::string at = file + ": noise at iso " + number(row.iso);
        if (!(row.iso > last_iso) || !(row.iso <= most_noise_iso))
            fail(at, "iso must be positive, rise from row to row, and stay below 1e7");
        last_iso = row.iso;
        check_betas(row, profile.cfa.sites(), at);
        check_shape(row, profile.noise.front(), at);
    }
    if (!profile.noise_effects)
        return;
    const auto& [of_light, of_readout] = *profile.noise_effects;
    try {
        noise_effects_from_names({ of_light, of_readout });
    } catch (const Error& error) {
        fail(file, std::string("noise_effects ") + error.what());
    }
    if (of_readout == "heavy_tailed_noise" && !profile.noise.empty()
        && !profile.noise.front().shape)
        fail(file,
             "noise_effects: heavy_tailed_noise needs tukey_lambda and row_sigma in "
             "each row of noise: add them, or say read_noise");
}

NoiseAtIso noise_at(const SensorProfile& profile, double iso)
{
    const auto& table = profile.noise;
    if (table.empty())
        throw Error(
            "sensor " + profile.id
            + " has no measured noise: leave the ISO out, or measure it by cg2raw "
              "calibrate (docs/calibrate.md)");
    if (table.size() == 1 && iso != table.front().iso)
        throw Error(
            "iso " + number(iso) + ": the noise of sensor " + profile.id
            + " is known at ISO " + number(table.front().iso)
            + " only: give that ISO, or add others to \"noise\" in its profile");
    const double lowest = table.front().iso / reach, highest = table.back().iso * reach;
    if (!(iso >= lowest && iso <= highest))
        throw Error("iso " + number(iso) + " is outside " + number(lowest) + " to "
                    + number(highest) + ", one stop around the ISOs that sensor "
                    + profile.id + " was calibrated at: " + isos_of(table));
    const auto above
        = std::find_if(table.begin(), table.end(),
                       [&](const NoiseAtIso& row) { return row.iso >= iso; });
    if (above != table.end() && above->iso == iso)
        return *above;
    const std::size_t second = std::clamp<std::size_t>(
        std::size_t(above - table.begin()), 1, table.size() - 1);
    const NoiseAtIso &a = table[second - 1], &b = table[second];
    const double weight = natural_log(iso / a.iso) / natural_log(b.iso / a.iso);
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

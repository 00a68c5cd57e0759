// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file A sensor profile written as the JSON, schema 1, that parse_profile reads back.
#include "cg2raw/profile.h"

#include "cfa.h"
#include "profile_json_spectral.h"
#include "profile_lamps.h"
#include "profile_syntax.h"

namespace cg2raw {
namespace {

/// Bayer keeps its four numbers; a larger repeat says no more than it must.
JsonTree json_of(const std::vector<double>& sites, const CfaPattern& cfa)
{
    if (cfa.width == 2)
        return sites;
    const std::vector<double> numbers = fewest_numbers(sites, cfa);
    return numbers.size() == 1 ? JsonTree(numbers.front()) : JsonTree(numbers);
}

JsonTree json_of(const std::array<double, 3>& covariance)
{
    const auto& [rr, rb, bb] = covariance;
    return std::array<std::array<double, 2>, 2> { { { rr, rb }, { rb, bb } } };
}

/// A list of what @p json_of_one makes of each; null of none.
template <class T, class JsonOfOne>
JsonTree list_of(const std::vector<T>& values, const JsonOfOne& json_of_one)
{
    JsonTree::Array list;
    for (const T& value : values)
        list.push_back(json_of_one(value));
    return list.empty() ? JsonTree() : JsonTree(std::move(list));
}

/// Sets a member, unless it would be null.
void put(JsonTree& json, const std::string& name, JsonTree value)
{
    if (!value.is_null())
        json.set(name, std::move(value));
}

JsonTree json_of(const NeutralDistribution& distribution)
{
    if (!distribution.neutrals.empty())
        return JsonTree::object().with("neutrals", distribution.neutrals);
    JsonTree json = JsonTree::object()
                        .with("mean", distribution.mean)
                        .with("covariance", json_of(distribution.covariance))
                        .with("hull", distribution.hull);
    put(json, "mixture", list_of(distribution.mixture, [](const NeutralGaussian& one) {
            return JsonTree::object()
                .with("weight", one.weight)
                .with("mean", one.mean)
                .with("covariance", json_of(one.covariance));
        }));
    return json;
}

JsonTree json_of(const NoiseAtIso& row, const CfaPattern& cfa)
{
    JsonTree json = JsonTree::object()
                        .with("iso", row.iso)
                        .with("beta1", json_of(row.beta1, cfa))
                        .with("beta2", json_of(row.beta2, cfa));
    if (row.shape) {
        json.set("tukey_lambda", row.shape->tukey_lambda);
        json.set("row_sigma", row.shape->row_sigma);
    }
    if (row.shape && row.shape->outliers) {
        json.set("outlier_fraction", row.shape->outliers->fraction);
        json.set("outlier_variance_ratio", row.shape->outliers->variance_ratio);
    }
    return json;
}

JsonTree json_of(const EffectSetting& setting)
{
    JsonTree json = JsonTree::object()
                        .with("name", setting.name)
                        .with("parameters", setting.parameters);
    if (!setting.evidence.empty())
        json.update(JsonTree::parse(setting.evidence));
    return json;
}

void put_calibrations(const SensorProfile& profile, JsonTree& json)
{
    for (std::size_t i = 0; i < profile.calibrations.size(); ++i) {
        const Calibration& calibration = profile.calibrations[i];
        const std::string number = "_" + std::to_string(i + 1);
        json.set("calibration_illuminant" + number,
                 light_source_name(calibration.light_source));
        json.set("color_matrix" + number, calibration.camera_from_xyz.m);
        if (calibration.xyz_d50_from_camera)
            json.set("forward_matrix" + number, calibration.xyz_d50_from_camera->m);
    }
}

JsonTree sources_of(const SensorProfile& profile)
{
    JsonTree json = JsonTree::object();
    for (const auto& [field, source] : profile.sources)
        json.set(field, source);
    return json;
}

/// What a profile may say of light and of noise.
void put_measured(const SensorProfile& profile, JsonTree& json)
{
    put(json, "lamps",
        list_of(profile.lamps, [](const Lamp& lamp) { return json_of(lamp); }));
    if (profile.spectral_sensitivities)
        json.set("spectral_sensitivities",
                 json_of(*profile.spectral_sensitivities, profile.cfa));
    const auto& lights = profile.illuminants;
    if (!lights.neutrals.empty() || !lights.hull.empty())
        json.set("illuminants", json_of(lights));
    if (profile.digital_gain)
        json.set("digital_gain",
                 JsonTree::object()
                     .with("mean", profile.digital_gain->mean)
                     .with("sigma", profile.digital_gain->sigma));
    put(json, "noise", list_of(profile.noise, [&](const NoiseAtIso& row) {
            return json_of(row, profile.cfa);
        }));
    if (profile.noise_effects)
        json.set("noise_effects",
                 std::array { profile.noise_effects->of_light,
                              profile.noise_effects->of_readout });
    put(json, "effects", list_of(profile.effects, [](const EffectSetting& setting) {
            return json_of(setting);
        }));
}

JsonTree json_of(const SensorProfile& profile)
{
    JsonTree json = JsonTree::object()
                        .with("schema", profile_schema)
                        .with("id", profile.id)
                        .with("make", profile.make)
                        .with("model", profile.model)
                        .with("unique_camera_model", profile.unique_camera_model)
                        .with("sources", sources_of(profile))
                        .with("cfa", name_of(profile.cfa))
                        .with("width", profile.width)
                        .with("height", profile.height)
                        .with("bits", profile.bits)
                        .with("black_level", json_of(profile.black_level, profile.cfa))
                        .with("white_level", profile.white_level);
    put_calibrations(profile, json);
    put_measured(profile, json);
    return json;
}

} // namespace

std::string to_json(const SensorProfile& profile)
{
    try {
        return json_of(profile).dump() + "\n";
    } catch (const Error& error) {
        throw Error("sensor " + profile.id
                    + " cannot be written as JSON: " + error.what()
                    + "; its texts must be UTF-8, and evidence the text of an object");
    }
}

} // namespace cg2raw

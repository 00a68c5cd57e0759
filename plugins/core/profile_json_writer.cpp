// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file A sensor profile written as the JSON, schema 1, that parse_profile reads back.
#include "cg2raw/profile.h"

#include "cfa.h"
#include "profile_json_spectral.h"
#include "profile_lamps.h"
#include "profile_syntax.h"

#include <nlohmann/json.hpp>

namespace cg2raw {
namespace {

using Json = nlohmann::ordered_json;

/// Bayer keeps its four numbers; a larger repeat says no more than it must.
Json json_of(const std::vector<double>& sites, const CfaPattern& cfa)
{
    if (cfa.width == 2)
        return sites;
    const std::vector<double> numbers = fewest_numbers(sites, cfa);
    return numbers.size() == 1 ? Json(numbers.front()) : Json(numbers);
}

Json json_of(const std::array<double, 3>& covariance)
{
    const auto& [rr, rb, bb] = covariance;
    return { { rr, rb }, { rb, bb } };
}

Json json_of(const NeutralDistribution& distribution)
{
    if (!distribution.neutrals.empty())
        return { { "neutrals", distribution.neutrals } };
    Json json { { "mean", distribution.mean },
                { "covariance", json_of(distribution.covariance) },
                { "hull", distribution.hull } };
    for (const NeutralGaussian& gaussian : distribution.mixture)
        json["mixture"].push_back({ { "weight", gaussian.weight },
                                    { "mean", gaussian.mean },
                                    { "covariance", json_of(gaussian.covariance) } });
    return json;
}

Json json_of(const NoiseAtIso& row, const CfaPattern& cfa)
{
    Json json { { "iso", row.iso },
                { "beta1", json_of(row.beta1, cfa) },
                { "beta2", json_of(row.beta2, cfa) } };
    if (row.shape) {
        json["tukey_lambda"] = row.shape->tukey_lambda;
        json["row_sigma"] = row.shape->row_sigma;
    }
    if (row.shape && row.shape->outliers) {
        json["outlier_fraction"] = row.shape->outliers->fraction;
        json["outlier_variance_ratio"] = row.shape->outliers->variance_ratio;
    }
    return json;
}

Json json_of(const EffectSetting& setting)
{
    Json json { { "name", setting.name }, { "parameters", setting.parameters } };
    if (!setting.evidence.empty())
        json.update(Json::parse(setting.evidence));
    return json;
}

void put_calibrations(const SensorProfile& profile, Json& json)
{
    for (std::size_t i = 0; i < profile.calibrations.size(); ++i) {
        const Calibration& calibration = profile.calibrations[i];
        const std::string number = "_" + std::to_string(i + 1);
        json["calibration_illuminant" + number]
            = light_source_name(calibration.light_source);
        json["color_matrix" + number] = calibration.camera_from_xyz.m;
        if (calibration.xyz_d50_from_camera)
            json["forward_matrix" + number] = calibration.xyz_d50_from_camera->m;
    }
}

Json json_of(const SensorProfile& profile)
{
    Json json { { "schema", profile_schema },
                { "id", profile.id },
                { "make", profile.make },
                { "model", profile.model },
                { "unique_camera_model", profile.unique_camera_model },
                { "sources", Json::object() },
                { "cfa", name_of(profile.cfa) },
                { "width", profile.width },
                { "height", profile.height },
                { "bits", profile.bits },
                { "black_level", json_of(profile.black_level, profile.cfa) },
                { "white_level", profile.white_level } };
    for (const auto& [field, source] : profile.sources)
        json["sources"][field] = source;
    put_calibrations(profile, json);
    for (const Lamp& lamp : profile.lamps)
        json["lamps"].push_back(json_of(lamp));
    if (profile.spectral_sensitivities)
        json["spectral_sensitivities"]
            = json_of(*profile.spectral_sensitivities, profile.cfa);
    const auto& lights = profile.illuminants;
    if (!lights.neutrals.empty() || !lights.hull.empty())
        json["illuminants"] = json_of(lights);
    if (profile.digital_gain)
        json["digital_gain"] = { { "mean", profile.digital_gain->mean },
                                 { "sigma", profile.digital_gain->sigma } };
    for (const NoiseAtIso& row : profile.noise)
        json["noise"].push_back(json_of(row, profile.cfa));
    if (profile.noise_effects)
        json["noise_effects"]
            = { profile.noise_effects->of_light, profile.noise_effects->of_readout };
    for (const EffectSetting& setting : profile.effects)
        json["effects"].push_back(json_of(setting));
    return json;
}

} // namespace

std::string to_json(const SensorProfile& profile)
{
    try {
        return json_of(profile).dump(2) + "\n";
    } catch (const nlohmann::json::exception& error) {
        throw Error("sensor " + profile.id
                    + " cannot be written as JSON: " + error.what()
                    + "; its texts must be UTF-8, and evidence the text of an object");
    }
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The JSON of a sensor profile, schema 1, read strictly.
#include "cg2raw/profile.h"

#include "effect_names.h"
#include "profile_json_fields.h"
#include "profile_json_spectral.h"
#include "profile_lamps.h"
#include "profile_syntax.h"

#include <algorithm>

namespace cg2raw {
namespace {

Mat3 matrix(Fields& fields, const std::string& field)
{
    const auto values = fields.reals(field, 9);
    Mat3 result {};
    std::copy(values.begin(), values.end(), result.m.begin());
    return result;
}

std::vector<Calibration> calibrations(Fields& fields)
{
    std::vector<Calibration> result;
    for (const std::string number : { "_1", "_2" }) {
        const bool given = number == "_1" || fields.has("color_matrix" + number);
        if (!given && fields.has("calibration_illuminant" + number))
            fields.fail("calibration_illuminant" + number,
                        "is there without its matrix");
        if (!given && fields.has("forward_matrix" + number))
            fields.fail("forward_matrix" + number, "is there without its color_matrix");
        if (!given)
            continue;
        Calibration calibration {};
        const std::string light = fields.text("calibration_illuminant" + number);
        try {
            calibration.light_source = light_source_from_name(light);
        } catch (const Error& error) {
            fields.fail("calibration_illuminant" + number, error.what());
        }
        calibration.camera_from_xyz = matrix(fields, "color_matrix" + number);
        if (fields.has("forward_matrix" + number))
            calibration.xyz_d50_from_camera = matrix(fields, "forward_matrix" + number);
        result.push_back(calibration);
    }
    return result;
}

/// What speaks of colours has no meaning for one channel.
void refuse_colors(Fields& fields)
{
    for (const std::string field :
         { "calibration_illuminant_1", "color_matrix_1", "forward_matrix_1",
           "calibration_illuminant_2", "color_matrix_2", "forward_matrix_2", "lamps",
           "illuminants" })
        if (fields.has(field))
            fields.fail(field,
                        "has no meaning with cfa mono, which tells no colours apart: "
                        "leave it out");
}

std::array<double, 3> covariance(Fields& fields)
{
    const auto rows = fields.pairs("covariance");
    if (rows.size() != 2)
        fields.fail("covariance", "must be [[rr, rb], [rb, bb]]");
    return { rows[0][0], rows[0][1], rows[1][1] };
}

NeutralGaussian neutral_gaussian(Fields fields)
{
    const auto mean = fields.reals("mean", 2);
    const NeutralGaussian result { fields.real("weight"),
                                   { mean[0], mean[1] },
                                   covariance(fields) };
    fields.done();
    return result;
}

NeutralDistribution illuminants(Fields fields)
{
    NeutralDistribution result;
    if (fields.has("neutrals")) {
        result = distribution_of(fields.pairs("neutrals"));
    } else {
        const auto mean = fields.reals("mean", 2);
        result.mean = { mean[0], mean[1] };
        result.covariance = covariance(fields);
        result.hull = distribution_of(fields.pairs("hull")).hull;
        if (result.hull.empty())
            fields.fail("hull", "must hold at least 3 points that are not on a line");
        if (fields.has("mixture"))
            for (Fields& gaussian : fields.objects("mixture"))
                result.mixture.push_back(neutral_gaussian(std::move(gaussian)));
    }
    fields.done();
    return result;
}

/// calibrations and illuminants; a monochrome sensor has neither.
void read_colors(Fields& fields, SensorProfile& profile)
{
    if (profile.cfa.is_mono()) {
        refuse_colors(fields);
        return;
    }
    profile.calibrations = calibrations(fields);
    if (fields.has("lamps"))
        profile.lamps = lamps_from_json(fields.objects("lamps"));
    if (fields.has("illuminants"))
        profile.illuminants = illuminants(fields.object("illuminants"));
}

std::optional<NoiseShape> noise_shape(Fields& row)
{
    const bool lambda = row.has("tukey_lambda"), sigma = row.has("row_sigma");
    const bool fraction = row.has("outlier_fraction"),
               ratio = row.has("outlier_variance_ratio");
    if (!lambda && !sigma && !fraction && !ratio)
        return std::nullopt;
    NoiseShape shape { row.real("tukey_lambda"), row.real("row_sigma") };
    if (fraction || ratio)
        shape.outliers = Outliers { row.real("outlier_fraction"),
                                    row.real("outlier_variance_ratio") };
    return shape;
}

std::optional<NoiseEffects> noise_effects(Fields& fields)
{
    if (!fields.has("noise_effects"))
        return std::nullopt;
    const std::vector<std::string> names = fields.texts("noise_effects");
    try {
        return noise_effects_from_names(names);
    } catch (const Error& error) {
        fields.fail("noise_effects", error.what());
    }
}

std::vector<NoiseAtIso> noise(Fields& fields, const CfaPattern& cfa)
{
    std::vector<NoiseAtIso> result;
    if (!fields.has("noise"))
        return result;
    for (Fields& row : fields.objects("noise")) {
        result.push_back({ row.real("iso"), row.per_site("beta1", cfa),
                           row.per_site("beta2", cfa), noise_shape(row) });
        row.done();
    }
    return result;
}

std::vector<EffectSetting> effect_settings(Fields& fields)
{
    std::vector<EffectSetting> result;
    if (!fields.has("effects"))
        return result;
    for (Fields& row : fields.objects("effects")) {
        EffectSetting setting { row.text("name"), {}, "" };
        try {
            check_effect_name(setting.name);
        } catch (const Error& error) {
            row.fail("name", error.what());
        }
        if (row.has("parameters")) {
            Fields parameters = row.object("parameters");
            for (const auto& [name, value] : parameters.json().members())
                setting.parameters[name] = parameters.real(name);
        }
        for (const char* extra : { "ci95", "evidence" })
            if (row.has(extra))
                setting.evidence += (setting.evidence.empty() ? "{\"" : ", \"")
                    + std::string(extra) + "\": " + row.at(extra, "").dump(true);
        if (!setting.evidence.empty())
            setting.evidence += "}";
        row.done();
        result.push_back(setting);
    }
    return result;
}

std::vector<std::pair<std::string, std::string>> sources(Fields fields)
{
    std::vector<std::pair<std::string, std::string>> result;
    for (const auto& [name, value] : fields.json().members())
        result.emplace_back(name, fields.text(name));
    return result;
}

SensorProfile profile_from(Fields fields)
{
    SensorProfile profile {};
    if (fields.integer("schema") != profile_schema)
        fields.fail("schema", "must be 1, the only one that this version reads");
    profile.id = fields.text("id");
    if (const std::string fault = sensor_id_fault(profile.id); !fault.empty())
        fields.fail("id", fault);
    profile.make = fields.text("make");
    profile.model = fields.text("model");
    profile.unique_camera_model = fields.text("unique_camera_model");
    profile.sources = sources(fields.object("sources"));
    const std::string cfa = fields.text("cfa");
    try {
        profile.cfa = cfa_from_name(cfa);
    } catch (const Error& error) {
        fields.fail("", error.what());
    }
    profile.width = fields.integer("width");
    profile.height = fields.integer("height");
    profile.bits = fields.integer("bits");
    profile.black_level = fields.per_site("black_level", profile.cfa);
    profile.white_level = fields.integer("white_level");
    read_colors(fields, profile);
    if (fields.has("spectral_sensitivities"))
        profile.spectral_sensitivities = sensitivities_from_json(
            fields.object("spectral_sensitivities"), profile.cfa);
    if (fields.has("digital_gain")) {
        Fields gain = fields.object("digital_gain");
        profile.digital_gain = DigitalGain { gain.real("mean"), gain.real("sigma") };
        gain.done();
    }
    profile.noise = noise(fields, profile.cfa);
    profile.noise_effects = noise_effects(fields);
    profile.effects = effect_settings(fields);
    fields.done();
    return profile;
}

} // namespace

SensorProfile parse_profile(std::string_view text, const std::string& file)
{
    check_profile_syntax(text, file);
    const JsonTree json = JsonTree::parse(text);
    SensorProfile profile = profile_from({ json, file, "" });
    check(profile, file);
    return profile;
}

} // namespace cg2raw

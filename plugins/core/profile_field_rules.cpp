// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "profile_field_rules.h"

#include "effect_names.h"
#include "neutral_distribution.h"
#include "noise_table.h"
#include "profile_lamps.h"
#include "text.h"

namespace cg2raw {
namespace {

/// What @p read returns; its Error is one about a field.
template <class Read>
auto of_field(const Fields& fields, const std::string& name, const Read& read)
{
    try {
        return read();
    } catch (const Error& error) {
        fields.fail(name, error.what());
    }
}

std::string in_either_case(std::string_view word)
{
    std::string pattern;
    for (const char letter : lower_case(word))
        pattern += std::string { '[', char(letter - 'a' + 'A'), letter, ']' };
    return pattern;
}

/// [[rr, rb], [rb, bb]]
Rule<std::array<double, 3>> covariance()
{
    return { [](Fields& fields, const std::string& name) {
                const auto rows = fields.pairs(name);
                if (rows.size() != 2)
                    fields.fail(name, "must be [[rr, rb], [rb, bb]]");
                return std::array { rows[0][0], rows[0][1], rows[1][1] };
            },
             [](const std::array<double, 3>& value) {
                 const auto& [rr, rb, bb] = value;
                 return JsonTree(std::array<std::array<double, 2>, 2> {
                     { { rr, rb }, { rb, bb } } });
             },
             [] { return schema_of_list(schema_of_list(schema_of({}), 2, 2), 2, 2); } };
}

void describe_gaussian(Members& members, NeutralGaussian& gaussian)
{
    members("weight", gaussian.weight, real({ 0.0, 1.0 }));
    members("mean", gaussian.mean, ratios());
    members("covariance", gaussian.covariance, covariance());
}

void describe_listed(Members& members, NeutralDistribution& lights)
{
    members("neutrals", lights.neutrals, list_of_ratios(0));
}

void describe_summed_up(Members& members, NeutralDistribution& lights)
{
    members("mean", lights.mean, ratios());
    members("covariance", lights.covariance, covariance());
    members("hull", lights.hull, list_of_ratios(3));
    members.maybe(
        "mixture", lights.mixture,
        list_of<NeutralGaussian>(describe_gaussian, {}, most_neutral_gaussians));
}

void describe_power(Members& members, Spectrum& power)
{
    members("wavelengths", power.wavelengths, reals({}));
    members("values", power.values, reals({ 0.0, most_lamp_power }));
}

void describe_lamp(Members& members, Lamp& lamp)
{
    members("name", lamp.name, text("^[A-Za-z0-9._-]+$"));
    members.maybe("calibration_illuminant", lamp.calibration.light_source,
                  light_name(true));
    members("neutral", lamp.neutral, ratios());
    members("color_matrix", lamp.calibration.camera_from_xyz, matrix());
    members.maybe("power", lamp.power, object_of<Spectrum>(describe_power));
}

void describe_outliers(Members& members, Outliers& outliers)
{
    members("outlier_fraction", outliers.fraction, real({ 0.0, most_outliers }));
    members("outlier_variance_ratio", outliers.variance_ratio,
            real({ 1.0, most_outlier_variance_ratio }));
}

void describe_shape(Members& members, NoiseShape& shape)
{
    members("tukey_lambda", shape.tukey_lambda,
            real({ least_tukey_lambda, most_tukey_lambda }));
    members("row_sigma", shape.row_sigma, real({ 0.0, 1.0 }));
    members.together(shape.outliers, describe_outliers);
}

std::vector<std::string> channels_of(const CfaPattern& cfa)
{
    return cfa.is_mono() ? std::vector<std::string> { "mono" }
                         : std::vector<std::string> { "R", "G", "B" };
}

SpectralSensitivities sensitivities_from(Fields fields, const CfaPattern& cfa)
{
    SpectralSensitivities result;
    result.wavelengths = fields.reals("wavelengths", 0);
    const std::size_t count = result.wavelengths.size();
    result.rgb.resize(count);
    const std::vector<std::string> channels = channels_of(cfa);
    for (std::size_t channel : { 0, 1, 2 }) {
        const std::string& name = channels[channel % channels.size()];
        const std::vector<double> values = fields.reals(name, 0);
        if (values.size() != count)
            fields.fail(name,
                        "has " + std::to_string(values.size())
                            + " values; it needs one per wavelength, "
                            + std::to_string(count));
        for (std::size_t i = 0; i < count; ++i)
            result.rgb[i][channel] = values[i];
    }
    if (fields.has("unit"))
        result.unit = of_field(fields, "unit", [&] {
            return spectral_unit_from_name(fields.text("unit"));
        });
    if (fields.has("scale"))
        result.scale = fields.real("scale");
    fields.done();
    return result;
}

JsonTree json_of(const SpectralSensitivities& sensitivities, const CfaPattern& cfa)
{
    JsonTree json = JsonTree::object()
                        .with("unit", name_of(sensitivities.unit))
                        .with("scale", sensitivities.scale)
                        .with("wavelengths", sensitivities.wavelengths);
    const std::vector<std::string> channels = channels_of(cfa);
    for (std::size_t channel = 0; channel < channels.size(); ++channel) {
        std::vector<double> values;
        for (const Vec3& rgb : sensitivities.rgb)
            values.push_back(rgb[channel]);
        json.set(channels[channel], values);
    }
    return json;
}

EffectSetting effect_setting(Fields& row)
{
    EffectSetting setting { row.text("name"), {}, "" };
    of_field(row, "name", [&] {
        check_effect_name(setting.name);
        return 0;
    });
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
    return setting;
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

} // namespace

Rule<std::string> sensor_id()
{
    Rule<std::string> rule = text("^[a-z0-9][a-z0-9.-]{0,99}$");
    rule.fault = sensor_id_fault;
    return rule;
}

Rule<TextsByField> source_texts()
{
    return { [](Fields& fields, const std::string& name) {
                TextsByField result;
                Fields texts = fields.object(name);
                for (const auto& [field, value] : texts.json().members())
                    result.emplace_back(field, texts.text(field));
                return result;
            },
             [](const TextsByField& texts) {
                 JsonTree json = JsonTree::object();
                 for (const auto& [field, text] : texts)
                     json.set(field, text);
                 return json;
             },
             [] {
                 return schema_of_type("object").with("additionalProperties",
                                                      text().schema());
             } };
}

const std::string& mono_pattern()
{
    static const std::string pattern = in_either_case("mono");
    return pattern;
}

std::vector<CfaPatterns> cfa_patterns()
{
    const std::string each = "(?=.*[Rr])(?=.*[Gg])(?=.*[Bb])[RGBrgb]";
    std::string bayer;
    for (const char* cfa : { "RGGB", "GRBG", "GBRG", "BGGR" })
        bayer += (bayer.empty() ? "(?:" : "|") + in_either_case(cfa);
    return { { bayer + ")", { 1, 3, 4 } },
             { each + "{16}", { 1, 3, 16 } },
             { each + "{36}", { 1, 3, 36 } },
             { mono_pattern(), { 1 } } };
}

Rule<CfaPattern> cfa_name()
{
    return { [](Fields& fields, const std::string& name) {
                const std::string word = fields.text(name);
                return of_field(fields, "", [&] { return cfa_from_name(word); });
            },
             [](const CfaPattern& cfa) { return JsonTree(name_of(cfa)); },
             [] {
                 std::string all;
                 for (const CfaPatterns& one : cfa_patterns())
                     all += (all.empty() ? "^(?:" : "|") + one.pattern;
                 return schema_of_type("string").with("pattern", all + ")$");
             } };
}

Rule<int> light_name(bool with_other)
{
    const std::string other = light_source_name(other_light_source);
    return { [=](Fields& fields, const std::string& name) {
                const std::string word = fields.text(name);
                if (with_other && word == other)
                    return other_light_source;
                try {
                    return light_source_from_name(word);
                } catch (const Error& error) {
                    fields.fail(name, error.what() + (with_other ? ", " + other : ""));
                }
            },
             [](int light_source) { return JsonTree(light_source_name(light_source)); },
             [=] {
                 std::vector<std::string> names = light_source_names();
                 if (with_other)
                     names.push_back(other);
                 return schema_of_words(names);
             } };
}

Rule<std::vector<Lamp>> lamp_list()
{
    Lamp before {};
    before.calibration.light_source = other_light_source;
    return if_given(list_of<Lamp>(describe_lamp, before), Need::of_colors);
}

Rule<SpectralSensitivities> sensitivities(const CfaPattern& cfa)
{
    const auto schema = [] {
        const Bounds positive { {}, {}, 0.0 };
        JsonTree properties = JsonTree::object().with(
            "wavelengths", schema_of_list(schema_of(positive), 2));
        for (const char* channel : { "R", "G", "B", "mono" })
            properties.set(channel, schema_of_list(schema_of({}), 2));
        properties.set("unit",
                       schema_of_words({ name_of(SpectralUnit::energy),
                                         name_of(SpectralUnit::photon) }));
        properties.set("scale", schema_of(positive));
        JsonTree::Array forms;
        for (const std::vector<std::string>& channels :
             { channels_of({}), channels_of(mono_cfa()) })
            forms.push_back(JsonTree::object().with("required", channels));
        return schema_of_object(properties, { "wavelengths" }).with("oneOf", forms);
    };
    return if_given(Rule<SpectralSensitivities> {
        [=](Fields& fields, const std::string& name) {
            return sensitivities_from(fields.object(name), cfa);
        },
        [=](const SpectralSensitivities& value) { return json_of(value, cfa); },
        schema });
}

Rule<NeutralDistribution> neutral_distribution()
{
    const auto listed = object_of<NeutralDistribution>(describe_listed);
    const auto summed_up = object_of<NeutralDistribution>(describe_summed_up);
    const auto read = [=](Fields& fields, const std::string& name) {
        if (fields.object(name).has("neutrals"))
            return distribution_of(listed.read(fields, name).neutrals);
        NeutralDistribution result = summed_up.read(fields, name);
        result.hull = distribution_of(result.hull).hull;
        if (result.hull.empty())
            fields.fail(name + ".hull",
                        "must hold at least 3 points that are not on a line");
        return result;
    };
    const auto json = [=](const NeutralDistribution& lights) {
        if (lights.neutrals.empty() && lights.hull.empty())
            return JsonTree();
        return lights.neutrals.empty() ? summed_up.json(lights) : listed.json(lights);
    };
    const auto schema = [=] {
        JsonTree::Array forms { listed.schema() };
        forms.push_back(summed_up.schema());
        return JsonTree::object().with("oneOf", forms);
    };
    return if_given(Rule<NeutralDistribution> { read, json, schema }, Need::of_colors);
}

Rule<DigitalGain> gain_distribution()
{
    return if_given(object_of<DigitalGain>([](Members& members, DigitalGain& gain) {
        members("mean", gain.mean, real({ {}, {}, 0.0 }));
        members("sigma", gain.sigma, real({ 0.0 }));
    }));
}

Rule<std::vector<NoiseAtIso>> noise_table(const CfaPattern& cfa)
{
    return if_given(list_of<NoiseAtIso>([=](Members& members, NoiseAtIso& row) {
        members("iso", row.iso, real({ {}, most_noise_iso, 0.0 }));
        members("beta1", row.beta1, per_site(cfa, { 0.0, 1.0 }));
        members("beta2", row.beta2, per_site(cfa, { 0.0, 1.0 }));
        members.together(row.shape, describe_shape);
    }));
}

Rule<NoiseEffects> noise_effect_names()
{
    const auto schema = [] {
        JsonTree::Array drawn { schema_of_words(
            { "shot_noise", "poisson_shot_noise" }) };
        drawn.push_back(schema_of_words({ "read_noise", "heavy_tailed_noise" }));
        return schema_of_type("array")
            .with("prefixItems", drawn)
            .with("minItems", 2)
            .with("maxItems", 2);
    };
    return if_given(Rule<NoiseEffects> {
        [](Fields& fields, const std::string& name) {
            const std::vector<std::string> names = fields.texts(name);
            return of_field(fields, name,
                            [&] { return noise_effects_from_names(names); });
        },
        [](const NoiseEffects& effects) {
            return JsonTree(std::array { effects.of_light, effects.of_readout });
        },
        schema });
}

Rule<std::vector<EffectSetting>> effect_settings()
{
    return if_given(Rule<std::vector<EffectSetting>> {
        [](Fields& fields, const std::string& name) {
            std::vector<EffectSetting> result;
            for (Fields& row : fields.objects(name))
                result.push_back(effect_setting(row));
            return result;
        },
        [](const std::vector<EffectSetting>& settings) {
            JsonTree::Array list;
            for (const EffectSetting& setting : settings)
                list.push_back(json_of(setting));
            return list.empty() ? JsonTree() : JsonTree(std::move(list));
        },
        [] { return schema_of_type("array"); } }); // items: effect_schema.cpp
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The JSON of a sensor profile, schema 1: read strictly, written back whole.
#include "cg2raw/profile.h"

#include "cfa.h"
#include "effect_names.h"
#include "profile_syntax.h"
#include "text.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <set>

namespace cg2raw {
namespace {

using Json = nlohmann::ordered_json;

constexpr int schema_version = 1;

/// A JSON object that knows its file and path, and which of its fields were asked for.
class Fields {
public:
    Fields(const Json& json, std::string file, std::string path)
        : m_json(json)
        , m_file(std::move(file))
        , m_path(std::move(path))
    {
        if (!json.is_object())
            fail("", "must be an object");
    }

    [[noreturn]] void fail(const std::string& field, const std::string& what) const
    {
        throw Error(m_file + ": " + m_path + field + (field.empty() ? "" : " ") + what);
    }

    bool has(const std::string& field)
    {
        m_asked.insert(field);
        return m_json.contains(field) && !m_json.at(field).is_null();
    }

    const Json& at(const std::string& field, const char* allowed)
    {
        if (!has(field))
            fail(field, std::string("is missing: ") + allowed);
        return m_json.at(field);
    }

    std::string text(const std::string& field)
    {
        const Json& value = at(field, "a text");
        if (!value.is_string() || value.get<std::string>().empty())
            fail(field, "must be a text that is not empty");
        return value.get<std::string>();
    }

    int integer(const std::string& field)
    {
        const Json& value = at(field, "a whole number");
        const double as_double = value.is_number() ? value.get<double>() : 0.5;
        if (!(std::abs(as_double) < 1e9) || as_double != std::floor(as_double))
            fail(field, "must be a whole number below 1e9, not " + shown(value));
        return int(as_double);
    }

    double real(const std::string& field)
    {
        return real_of(at(field, "a number"), field);
    }

    /// @p count numbers; 0: any count.
    std::vector<double> reals(const std::string& field, std::size_t count)
    {
        return reals_of(at(field, "a list of numbers"), field, count);
    }

    /// One number per site of @p cfa; the file may say one for all, or one per colour.
    std::vector<double> per_site(const std::string& field, const CfaPattern& cfa)
    {
        const Json& value = at(field, "a number, or a list of them");
        if (!value.is_number() && !value.is_array())
            fail(field, "must be a number or a list of numbers, not " + shown(value));
        const std::vector<double> numbers = value.is_number()
            ? std::vector<double> { value.get<double>() }
            : reals_of(value, field, 0);
        try {
            return spread_over_sites(numbers, cfa);
        } catch (const Error& error) {
            fail(field, error.what());
        }
    }

    std::vector<std::array<double, 2>> pairs(const std::string& field)
    {
        std::vector<std::array<double, 2>> result;
        const Json& list = at(field, "a list of [R/G, B/G]");
        if (!list.is_array())
            fail(field, "must be a list of [R/G, B/G], not " + shown(list));
        for (const Json& pair : list) {
            const auto values = reals_of(pair, field, 2);
            result.push_back({ values[0], values[1] });
        }
        return result;
    }

    std::vector<std::string> texts(const std::string& field)
    {
        std::vector<std::string> result;
        const Json& list = at(field, "a list of texts");
        if (!list.is_array())
            fail(field, "must be a list of texts, not " + shown(list));
        for (const Json& value : list) {
            if (!value.is_string())
                fail(field, "must be a list of texts, not " + shown(list));
            result.push_back(value.get<std::string>());
        }
        return result;
    }

    Fields object(const std::string& field)
    {
        return { at(field, "an object"), m_file, m_path + field + "." };
    }

    std::vector<Fields> objects(const std::string& field)
    {
        const Json& list = at(field, "a list of objects");
        if (!list.is_array())
            fail(field, "must be a list, not " + shown(list));
        std::vector<Fields> result;
        for (std::size_t i = 0; i < list.size(); ++i)
            result.emplace_back(list[i], m_file,
                                m_path + field + "[" + std::to_string(i) + "].");
        return result;
    }

    const Json& json() const { return m_json; }

    /// Fields that nobody asked for are errors.
    void done() const
    {
        for (const auto& [name, value] : m_json.items())
            if (!m_asked.count(name))
                fail(name,
                     "is unknown; known here: "
                         + joined({ m_asked.begin(), m_asked.end() }));
    }

private:
    static std::string shown(const Json& value)
    {
        const std::string text
            = value.dump(-1, ' ', true, Json::error_handler_t::replace);
        return text.size() > 40 ? text.substr(0, 40) + "..." : text;
    }

    double real_of(const Json& value, const std::string& field) const
    {
        if (!value.is_number())
            fail(field, "must be a number, not " + shown(value));
        return value.get<double>();
    }

    std::vector<double> reals_of(const Json& list, const std::string& field,
                                 std::size_t count) const
    {
        if (!list.is_array() || (count && list.size() != count))
            fail(field,
                 "must be a list of " + (count ? std::to_string(count) + " " : "")
                     + "numbers, not " + shown(list));
        std::vector<double> result;
        for (const Json& value : list)
            result.push_back(real_of(value, field));
        return result;
    }

    const Json& m_json;
    std::string m_file, m_path;
    std::set<std::string> m_asked;
};

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

NeutralDistribution illuminants(Fields fields)
{
    NeutralDistribution result;
    if (fields.has("neutrals")) {
        result = distribution_of(fields.pairs("neutrals"));
    } else {
        const auto mean = fields.reals("mean", 2);
        const auto covariance = fields.pairs("covariance");
        if (covariance.size() != 2)
            fields.fail("covariance", "must be [[rr, rb], [rb, bb]]");
        result.mean = { mean[0], mean[1] };
        result.covariance = { covariance[0][0], covariance[0][1], covariance[1][1] };
        result.hull = distribution_of(fields.pairs("hull")).hull;
        if (result.hull.empty())
            fields.fail("hull", "must hold at least 3 points that are not on a line");
    }
    fields.done();
    return result;
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
            for (const auto& [name, value] : parameters.json().items())
                setting.parameters[name] = parameters.real(name);
        }
        for (const char* extra : { "ci95", "evidence" })
            if (row.has(extra))
                setting.evidence += (setting.evidence.empty() ? "{\"" : ", \"")
                    + std::string(extra) + "\": " + row.at(extra, "").dump();
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
    for (const auto& [name, value] : fields.json().items())
        result.emplace_back(name, fields.text(name));
    return result;
}

SensorProfile profile_from(Fields fields)
{
    SensorProfile profile {};
    if (fields.integer("schema") != schema_version)
        fields.fail("schema", "must be 1, the only one that this version reads");
    profile.id = fields.text("id");
    const auto legal = "abcdefghijklmnopqrstuvwxyz0123456789-.";
    if (profile.id.find_first_not_of(legal) != std::string::npos)
        fields.fail("id",
                    "\"" + profile.id
                        + "\" must be of lower-case letters, digits, '-' and '.'");
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
    profile.calibrations = calibrations(fields);
    if (fields.has("illuminants"))
        profile.illuminants = illuminants(fields.object("illuminants"));
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

/// Bayer keeps its four numbers; a larger repeat says no more than it must.
Json json_of(const std::vector<double>& sites, const CfaPattern& cfa)
{
    if (cfa.width == 2)
        return sites;
    const std::vector<double> numbers = fewest_numbers(sites, cfa);
    return numbers.size() == 1 ? Json(numbers.front()) : Json(numbers);
}

Json json_of(const NeutralDistribution& distribution)
{
    if (!distribution.neutrals.empty())
        return { { "neutrals", distribution.neutrals } };
    const auto& [rr, rb, bb] = distribution.covariance;
    return { { "mean", distribution.mean },
             { "covariance", { { rr, rb }, { rb, bb } } },
             { "hull", distribution.hull } };
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
    Json json { { "schema", schema_version },
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

SensorProfile parse_profile(std::string_view text, const std::string& file)
{
    check_profile_syntax(text, file);
    const Json json = Json::parse(text);
    try {
        const SensorProfile profile = profile_from({ json, file, "" });
        check(profile, file);
        return profile;
    } catch (const nlohmann::json::exception& error) {
        throw Error(file + ": " + error.what());
    }
}

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

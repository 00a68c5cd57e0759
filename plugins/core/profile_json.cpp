// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The JSON of a sensor profile, schema 1: read strictly, written, and described.
#include "cg2raw/profile.h"

#include "profile_field_rules.h"
#include "profile_json.h"
#include "profile_syntax.h"

namespace cg2raw {
namespace {

void refuse_of_mono(Fields& fields, const std::string& name)
{
    if (fields.has(name))
        fields.fail(name,
                    "has no meaning with cfa mono, which tells no colours apart: leave "
                    "it out");
}

// Reading.

/// @p Value : T, or an optional one.
template <class Value, class T>
void read_field(Fields& fields, const CfaPattern& cfa, const char* name, Value& value,
                const Rule<T>& rule)
{
    if (rule.need == Need::of_colors && cfa.is_mono())
        refuse_of_mono(fields, name);
    else if (rule.need == Need::always || fields.has(name))
        value = rule.read(fields, name);
}

/// Functions, since of a text that is made while a plugin is loaded nobody catches
/// exceptions.
std::string light_field(const std::string& n) { return "calibration_illuminant_" + n; }
std::string matrix_field(const std::string& n) { return "color_matrix_" + n; }
std::string forward_field(const std::string& n) { return "forward_matrix_" + n; }

void read_field(Fields& fields, const CfaPattern& cfa, const char* /*name*/,
                std::vector<Calibration>& calibrations, const ColorMatrices& /*rule*/)
{
    for (const std::string n : { "1", "2" }) {
        if (cfa.is_mono()) {
            for (const auto& field : { light_field, matrix_field, forward_field })
                refuse_of_mono(fields, field(n));
            continue;
        }
        if (n == "2" && !fields.has(matrix_field(n))) {
            if (fields.has(light_field(n)))
                fields.fail(light_field(n), "is there without its matrix");
            if (fields.has(forward_field(n)))
                fields.fail(forward_field(n), "is there without its color_matrix");
            continue;
        }
        Calibration calibration {};
        calibration.light_source = light_name().read(fields, light_field(n));
        calibration.camera_from_xyz = matrix().read(fields, matrix_field(n));
        if (fields.has(forward_field(n)))
            calibration.xyz_d50_from_camera = matrix().read(fields, forward_field(n));
        calibrations.push_back(calibration);
    }
}

SensorProfile profile_from(Fields fields)
{
    if (fields.integer("schema") != profile_version)
        fields.fail("schema", "must be 1, the only one that this version reads");
    SensorProfile profile {};
#define CG2RAW_FIELD(type, name, rule, meaning)                                        \
    read_field(fields, profile.cfa, #name, profile.name, rule);
#include "cg2raw/profile_fields.def"
#undef CG2RAW_FIELD
    fields.done();
    return profile;
}

// Writing.

template <class T>
void write_field(JsonTree& json, const char* name, const T& value, const Rule<T>& rule)
{
    if (JsonTree written = rule.json(value); !written.is_null())
        json.set(name, std::move(written));
}

template <class T>
void write_field(JsonTree& json, const char* name, const std::optional<T>& value,
                 const Rule<T>& rule)
{
    if (value)
        write_field(json, name, *value, rule);
}

void write_field(JsonTree& json, const char* /*name*/,
                 const std::vector<Calibration>& calibrations,
                 const ColorMatrices& /*rule*/)
{
    for (std::size_t i = 0; i < calibrations.size(); ++i) {
        const auto& [light, matrix, forward] = calibrations[i];
        const std::string n = std::to_string(i + 1);
        json.set(light_field(n), light_source_name(light));
        json.set(matrix_field(n), matrix.m);
        if (forward)
            json.set(forward_field(n), forward->m);
    }
}

JsonTree json_of(const SensorProfile& profile)
{
    JsonTree json = JsonTree::object().with("schema", profile_version);
#define CG2RAW_FIELD(type, name, rule, meaning)                                        \
    write_field(json, #name, profile.name, rule);
#include "cg2raw/profile_fields.def"
#undef CG2RAW_FIELD
    return json;
}

// Checking.

template <class T>
void check_field(const std::string& file, const char* name, const T& value,
                 const Rule<T>& rule)
{
    if (const std::string fault = rule.fault ? rule.fault(value) : ""; !fault.empty())
        throw Error(file + ": " + name + " " + fault);
}

template <class T>
void check_field(const std::string& file, const char* name,
                 const std::optional<T>& value, const Rule<T>& rule)
{
    if (value)
        check_field(file, name, *value, rule);
}

void check_field(const std::string& /*file*/, const char* /*name*/,
                 const std::vector<Calibration>& /*value*/,
                 const ColorMatrices& /*rule*/)
{
}

// Describing.

/// The schema's properties, and of which there must be one.
struct Properties {
    JsonTree all = JsonTree::object();
    JsonTree::Array required;
    std::vector<std::string> of_colors; ///< which a monochrome sensor has not

    void add(const std::string& name, const char* meaning, const JsonTree& schema)
    {
        JsonTree described = JsonTree::object().with("description", meaning);
        described.update(schema);
        all.set(name, std::move(described));
    }
};

template <class T>
void describe_field(Properties& properties, const char* name, const char* meaning,
                    const Rule<T>& rule)
{
    properties.add(name, meaning, rule.schema());
    if (rule.need == Need::always)
        properties.required.emplace_back(name);
    if (rule.need == Need::of_colors)
        properties.of_colors.emplace_back(name);
}

void describe_field(Properties& properties, const char* /*name*/,
                    const char* /*meaning*/, const ColorMatrices& /*rule*/)
{
    const JsonTree light = light_name().schema(), numbers = matrix().schema();
    properties.add(light_field("1"), "The light of color_matrix_1.", light);
    properties.add(matrix_field("1"),
                   "Camera RGB from CIE XYZ, 9 numbers row by row (DNG ColorMatrix1).",
                   numbers);
    properties.add(
        forward_field("1"),
        "CIE XYZ under D50 from white-balanced camera RGB (DNG ForwardMatrix1).",
        numbers);
    properties.add(light_field("2"),
                   "The light of color_matrix_2; of another temperature.", light);
    properties.add(
        matrix_field("2"),
        "As color_matrix_1; matrices are interpolated between the two lights.",
        numbers);
    properties.add(forward_field("2"), "As forward_matrix_1.", numbers);
    for (const auto& field : { light_field, matrix_field, forward_field })
        for (const char* n : { "1", "2" })
            properties.of_colors.push_back(field(n));
}

/// What depends on the CFA: the counts of numbers, and matrices.
JsonTree::Array rules_by_cfa(const std::vector<std::string>& of_colors)
{
    const auto object = [](const char* name, JsonTree value) {
        return JsonTree::object().with(name, std::move(value));
    };
    const auto requiring = [&](const std::vector<std::string>& names) {
        return object("required", names);
    };
    JsonTree::Array rules;
    for (const auto& [pattern, counts] : cfa_patterns()) {
        JsonTree::Array per_site { schema_of_type("number") };
        for (const int count : counts)
            per_site.push_back(schema_of_type("array")
                                   .with("minItems", count)
                                   .with("maxItems", count));
        const JsonTree sites = object("anyOf", per_site);
        const JsonTree row
            = object("properties", object("beta1", sites).with("beta2", sites));
        JsonTree then
            = object("properties",
                     object("black_level", sites).with("noise", object("items", row)));
        if (pattern == mono_pattern()) {
            JsonTree::Array none;
            for (const std::string& name : of_colors)
                none.push_back(requiring({ name }));
            then.set("not", object("anyOf", none));
        } else {
            then.set("required", std::vector { light_field("1"), matrix_field("1") });
        }
        const JsonTree cfa
            = schema_of_type("string").with("pattern", "^(?:" + pattern + ")$");
        rules.push_back(object("if",
                               object("properties", object("cfa", cfa))
                                   .with("required", JsonTree::Array { "cfa" }))
                            .with("then", then));
    }
    return rules;
}

} // namespace

JsonTree profile_schema(JsonTree effects)
{
    Properties properties;
    properties.add("schema", "Version of this format: 1.",
                   JsonTree::object().with("const", profile_version));
    properties.required.emplace_back("schema");
    const SensorProfile profile {};
#define CG2RAW_FIELD(type, name, rule, meaning)                                        \
    describe_field(properties, #name, meaning, rule);
#include "cg2raw/profile_fields.def"
#undef CG2RAW_FIELD
    JsonTree settings = *properties.all.find("effects");
    settings.set("items", std::move(effects));
    properties.all.set("effects", std::move(settings));
    const auto needs = [](const std::string& name) { return JsonTree::Array { name }; };
    JsonTree schema
        = JsonTree::object()
              .with("$schema", "https://json-schema.org/draft/2020-12/schema")
              .with("title", "cg2raw sensor profile");
    schema.update(schema_of_object(properties.all, properties.required));
    schema.set("dependentRequired",
               JsonTree::object()
                   .with(light_field("2"), needs(matrix_field("2")))
                   .with(matrix_field("2"), needs(light_field("2")))
                   .with(forward_field("2"), needs(matrix_field("2"))));
    schema.set("allOf", rules_by_cfa(properties.of_colors));
    return schema;
}

void check_fields(const SensorProfile& profile, const std::string& file)
{
#define CG2RAW_FIELD(type, name, rule, meaning)                                        \
    check_field(file, #name, profile.name, rule);
#include "cg2raw/profile_fields.def"
#undef CG2RAW_FIELD
}

SensorProfile parse_profile(std::string_view text, const std::string& file)
{
    check_profile_syntax(text, file);
    const JsonTree json = JsonTree::parse(text);
    SensorProfile profile = profile_from({ json, file, "" });
    check(profile, file);
    return profile;
}

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

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The JSON Schema of profiles, with the effects of the registry.
#include "cg2raw/effect.h"

#include "profile_json.h"
#include "profile_rules.h"

namespace cg2raw {
namespace {

JsonTree described(const std::string& text, const JsonTree& schema)
{
    JsonTree json = JsonTree::object().with("description", text);
    json.update(schema);
    return json;
}

/// With the bounds of its parameters.
JsonTree schema_of(const Effect& effect)
{
    JsonTree parameters = JsonTree::object();
    JsonTree::Array required, needed { "name" };
    for (const Parameter& p : effect.parameters) {
        parameters.set(
            p.name,
            described(p.meaning + ", " + p.unit, schema_of(Bounds { p.min, p.max })));
        if (!p.optional)
            required.emplace_back(p.name);
    }
    if (!required.empty())
        needed.emplace_back("parameters");
    const JsonTree properties
        = JsonTree::object()
              .with("name", JsonTree::object().with("const", effect.name))
              .with("parameters", schema_of_object(parameters, required))
              .with("ci95", JsonTree::object())
              .with("evidence", JsonTree::object());
    return described(effect.meaning, schema_of_object(properties, needed));
}

} // namespace

std::string profile_schema()
{
    JsonTree::Array one_of;
    for (const Effect& effect : all_effects())
        one_of.push_back(schema_of(effect));
    return profile_schema(JsonTree::object().with("oneOf", one_of)).dump() + "\n";
}

} // namespace cg2raw

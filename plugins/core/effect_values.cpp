// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "effect_values.h"

#include "text.h"

#include <algorithm>
#include <cmath>

namespace cg2raw {

namespace {

bool has_parameter(CfaRepeat repeat, const CfaPattern& cfa)
{
    return !cfa.is_mono() || repeat == CfaRepeat::any
        || repeat == CfaRepeat::first_site;
}

/// Of what no site of this CFA has anything.
bool is_foreign(CfaRepeat repeat, const CfaPattern& cfa)
{
    if (cfa.is_mono())
        return repeat == CfaRepeat::colors || repeat == CfaRepeat::bayer;
    const bool is_2x2 = cfa.width == 2 && cfa.height == 2;
    return !is_2x2
        && (repeat == CfaRepeat::bayer || repeat == CfaRepeat::first_site
            || repeat == CfaRepeat::other_site);
}

[[noreturn]] void fail_foreign(const Effect& effect, const Parameter& parameter,
                               const CfaPattern& cfa, const std::string& file)
{
    const std::string where = file + ": effect " + effect.name + ": ";
    if (cfa.is_mono())
        throw Error(
            where
            + "tells the colours of a CFA apart, and this sensor is monochrome: "
              "leave the effect out");
    throw Error(
        where + "parameter " + parameter.name + " is of a 2 x 2 CFA, and this one is "
        + std::to_string(cfa.height) + " x " + std::to_string(cfa.width)
        + ": leave the effect out; a profile of any CFA can give noise per site "
          "in its noise table, and black_level per site");
}

void check_each(const Effect& effect, const Values& values,
                const std::vector<Parameter>& parameters, const std::string& file)
{
    const std::string where = file + ": effect " + effect.name + ": ";
    if (values.size() != parameters.size()) {
        std::vector<std::string> names;
        for (const Parameter& parameter : parameters)
            names.push_back(parameter.name);
        throw Error(where + std::to_string(values.size()) + " values are given, and "
                    + std::to_string(names.size()) + " are needed: " + joined(names));
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto& [name, unit, min, max, null, meaning, repeat, whole, optional]
            = parameters[i];
        if (!(values[i] >= min && values[i] <= max))
            throw Error(where + name + " " + number(values[i]) + " is outside "
                        + number(min) + " to " + number(max) + " " + unit);
        if (whole && values[i] != std::floor(values[i]))
            throw Error(where + name + " " + number(values[i])
                        + " must be a whole number of " + number(min) + " to "
                        + number(max) + " " + unit);
    }
}

} // namespace

bool has_effect(const CfaPattern& cfa, const Effect& effect)
{
    return std::none_of(
        effect.parameters.begin(), effect.parameters.end(),
        [&](const Parameter& parameter) { return is_foreign(parameter.repeat, cfa); });
}

std::vector<Parameter> parameters_of(const Effect& effect, const CfaPattern& cfa,
                                     const std::string& file)
{
    std::vector<Parameter> parameters;
    for (const Parameter& parameter : effect.parameters) {
        if (is_foreign(parameter.repeat, cfa))
            fail_foreign(effect, parameter, cfa, file);
        if (has_parameter(parameter.repeat, cfa))
            parameters.push_back(parameter);
    }
    return parameters;
}

Values completed(const Effect& effect, Values values, const CfaPattern& cfa,
                 const std::string& file)
{
    const std::vector<Parameter> parameters = parameters_of(effect, cfa, file);
    while (values.size() < parameters.size() && parameters[values.size()].optional)
        values.push_back(parameters[values.size()].null);
    check_each(effect, values, parameters, file);
    return values;
}

Values values_of(const Effect& effect, const std::map<std::string, double>& given,
                 const CfaPattern& cfa, const std::string& file)
{
    const std::string where = file + ": effect " + effect.name + ": ";
    Values values;
    std::vector<std::string> names;
    const std::vector<Parameter> parameters = parameters_of(effect, cfa, file);
    for (const Parameter& parameter : parameters) {
        names.push_back(parameter.name);
        const auto found = given.find(parameter.name);
        if (found == given.end() && !parameter.optional)
            throw Error(where + "parameter " + parameter.name + " is missing ("
                        + parameter.meaning + ", " + number(parameter.min) + " to "
                        + number(parameter.max) + " " + parameter.unit + ")");
        values.push_back(found == given.end() ? parameter.null : found->second);
    }
    check_each(effect, values, parameters, file);
    for (const auto& [name, value] : given)
        if (std::find(names.begin(), names.end(), name) == names.end())
            throw Error(where + "parameter " + name
                        + " is unknown; known: " + joined(names));
    return values;
}

} // namespace cg2raw

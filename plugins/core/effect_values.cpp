// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "effect_values.h"

#include "text.h"

#include <algorithm>

namespace cg2raw {

void check_sites(const Effect& effect, const CfaPattern& cfa, const std::string& file)
{
    if (cfa.width == 2 && cfa.height == 2)
        return;
    for (const Parameter& parameter : effect.parameters)
        if (parameter.repeat == CfaRepeat::bayer)
            throw Error(file + ": effect " + effect.name + ": parameter "
                        + parameter.name + " is of a 2 x 2 CFA, and this one is "
                        + std::to_string(cfa.height) + " x " + std::to_string(cfa.width)
                        + ": leave the effect out; a profile of any CFA can give noise"
                          " per site in its noise table, and black_level per site");
}

void check_values(const Effect& effect, const Values& values, const std::string& file)
{
    const std::string where = file + ": effect " + effect.name + ": ";
    const std::vector<Parameter>& parameters = effect.parameters;
    if (values.size() != parameters.size()) {
        std::vector<std::string> names;
        for (const Parameter& parameter : parameters)
            names.push_back(parameter.name);
        throw Error(where + std::to_string(values.size()) + " values are given, and "
                    + std::to_string(names.size()) + " are needed: " + joined(names));
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto& [name, unit, min, max, null, meaning, repeat] = parameters[i];
        if (!(values[i] >= min && values[i] <= max))
            throw Error(where + name + " " + number(values[i]) + " is outside "
                        + number(min) + " to " + number(max) + " " + unit);
    }
}

Values values_of(const Effect& effect, const std::map<std::string, double>& given,
                 const std::string& file)
{
    const std::string where = file + ": effect " + effect.name + ": ";
    Values values;
    std::vector<std::string> names;
    for (const Parameter& parameter : effect.parameters) {
        names.push_back(parameter.name);
        const auto found = given.find(parameter.name);
        if (found == given.end())
            throw Error(where + "parameter " + parameter.name + " is missing ("
                        + parameter.meaning + ", " + number(parameter.min) + " to "
                        + number(parameter.max) + " " + parameter.unit + ")");
        values.push_back(found->second);
    }
    check_values(effect, values, file);
    for (const auto& [name, value] : given)
        if (std::find(names.begin(), names.end(), name) == names.end())
            throw Error(where + "parameter " + name
                        + " is unknown; known: " + joined(names));
    return values;
}

} // namespace cg2raw

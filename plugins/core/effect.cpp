// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/effect.h"

#include "effect_list.h"
#include "text.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace cg2raw {

const char* name_of(Stage stage)
{
    constexpr const char* names[]
        = { "color",      "optics",  "pixel",      "response", "noise",
            "saturation", "readout", "conversion", "output" };
    return names[std::size_t(stage)];
}

const char* name_of(Pattern pattern)
{
    constexpr const char* names[] = { "none", "fixed", "temporal" };
    return names[std::size_t(pattern)];
}

FieldPosition field_position(const Signal& signal, int row, int col)
{
    const auto [width, height] = signal.exposure.frame;
    const double half = std::hypot(width, height) / 2.0;
    return { (signal.origin.col + col + 0.5 - width / 2.0) / half,
             (signal.origin.row + row + 0.5 - height / 2.0) / half };
}

const std::vector<Effect>& all_effects()
{
    static const std::vector<Effect> sorted = [] {
        auto all = defined_effects();
        std::sort(all.begin(), all.end(), [](const Effect& a, const Effect& b) {
            return std::tie(a.stage, a.name) < std::tie(b.stage, b.name);
        });
        return all;
    }();
    return sorted;
}

const Effect& effect(std::string_view name)
{
    std::vector<std::string> names;
    for (const Effect& candidate : all_effects()) {
        if (candidate.name == name)
            return candidate;
        names.push_back(candidate.name);
    }
    throw Error("effect \"" + std::string(name)
                + "\" is unknown; known: " + joined(names));
}

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

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "profile_lamps.h"

#include "text.h"

#include <algorithm>

namespace cg2raw {
namespace {

constexpr std::string_view prefix = "lamp:";

/// A name as all its spellings: the alias of a colour space has '_' for '.' and '-'.
std::string folded(std::string_view name)
{
    std::string result = lower_case(name);
    for (char& c : result)
        if (c == '.' || c == '-')
            c = '_';
    return result;
}

int light_source_of(Fields& row)
{
    const std::string field = "calibration_illuminant";
    const std::string other = light_source_name(other_light_source);
    const std::string name = row.has(field) ? row.text(field) : other;
    if (name == other)
        return other_light_source;
    try {
        return light_source_from_name(name);
    } catch (const Error& error) {
        row.fail(field, std::string(error.what()) + ", " + other);
    }
}

} // namespace

const Lamp* lamp_named(const std::vector<Lamp>& lamps, std::string_view word)
{
    if (lower_case(word.substr(0, prefix.size())) == prefix)
        word.remove_prefix(prefix.size());
    const auto found = std::find_if(lamps.begin(), lamps.end(), [&](const Lamp& lamp) {
        return folded(lamp.name) == folded(word);
    });
    return found == lamps.end() ? nullptr : &*found;
}

std::vector<Lamp> lamps_from_json(std::vector<Fields> rows)
{
    std::vector<Lamp> result;
    for (Fields& row : rows) {
        Lamp lamp { row.text("name"), {}, {} };
        const std::vector<double> neutral = row.reals("neutral", 2);
        std::copy(neutral.begin(), neutral.end(), lamp.neutral.begin());
        lamp.calibration.light_source = light_source_of(row);
        const std::vector<double> matrix = row.reals("color_matrix", 9);
        std::copy(matrix.begin(), matrix.end(),
                  lamp.calibration.camera_from_xyz.m.begin());
        row.done();
        result.push_back(lamp);
    }
    return result;
}

Fields::Json json_of(const Lamp& lamp)
{
    return { { "name", lamp.name },
             { "calibration_illuminant",
               light_source_name(lamp.calibration.light_source) },
             { "neutral", lamp.neutral },
             { "color_matrix", lamp.calibration.camera_from_xyz.m } };
}

void check_names(const std::vector<Lamp>& lamps, const std::string& file)
{
    const auto legal
        = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-._";
    for (const Lamp& lamp : lamps) {
        if (lamp.name.empty() || lamp.name.find_first_not_of(legal) != lamp.name.npos)
            throw Error(file + ": lamps: name \"" + lamp.name
                        + "\" must be of letters, digits, '.', '_' and '-'");
        if (lamp_named(lamps, lamp.name) != &lamp)
            throw Error(file + ": lamps: \"" + lamp.name + "\" and \""
                        + lamp_named(lamps, lamp.name)->name
                        + "\" are one name; leave one of them out");
    }
}

} // namespace cg2raw

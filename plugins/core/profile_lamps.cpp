// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "profile_lamps.h"

#include "text.h"

#include <algorithm>
#include <cmath>

namespace cg2raw {
namespace {

constexpr std::string_view prefix = "lamp:";
constexpr double least_power = 1e-9; ///< relative

/// A name as all its spellings: the alias of a colour space has '_' for '.' and '-'.
std::string folded(std::string_view name)
{
    std::string result = lower_case(name);
    for (char& c : result)
        if (c == '.' || c == '-')
            c = '_';
    return result;
}

/// Wavelengths rise, and there is light in the visible range, nowhere less than none.
void check_power(const Lamp& lamp, const std::string& file)
{
    const std::string start = file + ": lamps: power of " + lamp.name;
    const auto& [nm, values] = *lamp.power;
    if (values.size() != nm.size())
        throw Error(start + " has " + std::to_string(values.size())
                    + " values; it needs one per wavelength, "
                    + std::to_string(nm.size()));
    for (std::size_t i = 1; i < nm.size(); ++i)
        if (!(nm[i] > nm[i - 1]))
            throw Error(start + ": wavelength " + number(nm[i]) + " nm comes after "
                        + number(nm[i - 1]) + " nm; they must rise");
    double total = 0.0;
    for (std::size_t i = 0; i < nm.size(); ++i) {
        if (!(values[i] >= 0.0 && values[i] <= most_lamp_power))
            throw Error(start + ": " + number(values[i]) + " must be 0 to "
                        + number(most_lamp_power));
        total += nm[i] > visible_from && nm[i] < visible_to ? values[i] : 0.0;
    }
    if (!(total > least_power))
        throw Error(start + " is nowhere above 0 between " + number(visible_from)
                    + " and " + number(visible_to) + " nm");
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

void check_lamps(const std::vector<Lamp>& lamps, const std::string& file)
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
        if (lamp.power)
            check_power(lamp, file);
    }
}

} // namespace cg2raw

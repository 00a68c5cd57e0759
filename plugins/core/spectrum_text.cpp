// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "spectrum_text.h"

#include "cg2raw/spectrum.h"
#include "cg2raw/types.h"
#include "platform/numbers.h"
#include "text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace cg2raw {
namespace {

constexpr double light_speed = 299792458.0; // m/s
constexpr double nm_per_metre = 1e9;
constexpr std::size_t longest_number = 40; ///< characters
constexpr std::size_t shown = 24; ///< of a text that is wrong, characters

struct Prefix {
    std::string_view name;
    double factor;
};

/// SI prefixes of the layout; the longer name first.
constexpr std::array<Prefix, 17> prefixes { {
    { "da", 1e1 },
    { "Y", 1e24 },
    { "Z", 1e21 },
    { "E", 1e18 },
    { "P", 1e15 },
    { "T", 1e12 },
    { "G", 1e9 },
    { "M", 1e6 },
    { "k", 1e3 },
    { "h", 1e2 },
    { "d", 1e-1 },
    { "c", 1e-2 },
    { "m", 1e-3 },
    { "u", 1e-6 },
    { "n", 1e-9 },
    { "p", 1e-12 },
    { "", 1.0 },
} };

bool ends_with(std::string_view text, std::string_view ending)
{
    return text.size() >= ending.size()
        && text.substr(text.size() - ending.size()) == ending;
}

std::string_view stripped(std::string_view text)
{
    constexpr std::string_view space = " \t\r\n";
    const auto first = text.find_first_not_of(space);
    if (first == text.npos)
        return {};
    return text.substr(first, text.find_last_not_of(space) + 1 - first);
}

/// The number of "550,5" or "5,5e-7"; NaN if it is none.
double number_before_unit(std::string_view text, char decimal)
{
    const auto is_part = [&](char c) {
        return (c >= '0' && c <= '9') || c == decimal || c == 'e' || c == 'E'
            || c == '+' || c == '-';
    };
    if (text.empty() || text.size() > longest_number
        || !std::all_of(text.begin(), text.end(), is_part))
        return std::nan("");
    std::string digits(text);
    std::replace(digits.begin(), digits.end(), decimal, '.');
    return number_in(digits);
}

/// A text, or its start, in quotation marks.
std::string quoted(std::string_view text)
{
    const std::string start(text.substr(0, shown));
    return "\"" + start + (text.size() > shown ? " ...\"" : "\"");
}

} // namespace

std::optional<double> wavelength_of(std::string_view word, char decimal)
{
    const bool is_frequency = ends_with(word, "Hz");
    if (!is_frequency && !ends_with(word, "m"))
        return std::nullopt;
    word.remove_suffix(is_frequency ? 2 : 1);
    for (const auto& [name, factor] : prefixes) {
        if (!ends_with(word, name))
            continue;
        const double value
            = number_before_unit(word.substr(0, word.size() - name.size()), decimal);
        const double nm = is_frequency ? nm_per_metre * light_speed / (value * factor)
                                       : value * (factor * nm_per_metre);
        if (nm >= shortest_of_channels && nm <= longest_of_channels)
            return nm;
    }
    return std::nullopt;
}

Spectrum spectrum_from_rows(std::vector<std::pair<double, double>> rows)
{
    std::sort(rows.begin(), rows.end());
    Spectrum result;
    double most = 0.0;
    for (const auto& [nm, value] : rows) {
        if (!(std::isfinite(nm) && std::isfinite(value) && value >= 0.0))
            throw Error("a spectrum has finite values that are not negative, not "
                        + number(value) + " at " + number(nm) + " nm");
        if (!result.wavelengths.empty() && !(nm > result.wavelengths.back()))
            throw Error("a spectrum has " + number(nm) + " nm twice");
        result.wavelengths.push_back(nm);
        result.values.push_back(value);
        most = std::max(most, value);
    }
    if (rows.size() < 2 || most == 0.0)
        throw Error("a spectrum needs two or more wavelengths, and a value above 0");
    return result;
}

Spectrum spectrum_from_text(std::string_view text)
{
    std::vector<std::pair<double, double>> rows;
    for (std::string_view rest = text; !stripped(rest).empty();) {
        const auto end = std::min(rest.find(';'), rest.size());
        const std::string_view row = stripped(rest.substr(0, end));
        rest.remove_prefix(std::min(end + 1, rest.size()));
        const auto colon = std::min(row.find(':'), row.size());
        const auto nm = wavelength_of(stripped(row.substr(0, colon)), '.');
        const std::string_view value = row.substr(std::min(colon + 1, row.size()));
        if (!nm || std::isnan(number_in(stripped(value))))
            throw Error("spectrum " + quoted(text)
                        + " must be pairs of wavelength and value as 550nm:0.3;");
        rows.emplace_back(*nm, number_in(stripped(value)));
    }
    return spectrum_from_rows(std::move(rows));
}

} // namespace cg2raw

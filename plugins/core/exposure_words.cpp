// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The words of an exposure, and the distributions that cg2raw match writes.
#include "cg2raw/exposure.h"

#include "platform/paths.h"
#include "profile_json_tree.h"
#include "text.h"
#include "text_file.h"

#include <cmath>

namespace cg2raw {
namespace {

/// Of what is no lamp, where nothing else is said (docs/exposure.md).
constexpr double usual_percentile = 98.0, usual_level = 0.8;
constexpr double most_stops = 64.0; ///< up or down
constexpr std::uintmax_t largest_match = 1 << 20; ///< bytes
constexpr const char* allowed
    = "stops from -64 to 64, auto, auto:PERCENTILE:LEVEL, random:LOW:HIGH, "
      "normal:MEAN:SD, match:FILE or match:FILE:draw";

using Kind = ExposureRule::Kind;

[[noreturn]] void fail(const std::string& text, const std::string& must)
{
    throw Error("exposure \"" + quotable(text) + "\" must be " + must);
}

/// The two numbers of "name:A:B". Throws Error.
std::array<double, 2> pair_of(const std::string& text, const std::string& form)
{
    const std::vector<std::string> words = split(text, ':');
    if (words.size() != 3)
        fail(text, form);
    const std::array<double, 2> pair { signed_number(words[1]),
                                       signed_number(words[2]) };
    if (!std::isfinite(pair[0]) || !std::isfinite(pair[1]))
        fail(text, form);
    return pair;
}

bool are_stops(double value) { return std::abs(value) <= most_stops; }

ExposureRule meter_from_text(const std::string& text)
{
    const std::string form = "auto:PERCENTILE:LEVEL, a percentile above 0 up to 100 "
                             "and a level from 0.001 to 1000 times white";
    const auto [percentile, level] = pair_of(text, form);
    if (!(percentile > 0.0 && percentile <= 100.0 && level >= 1e-3 && level <= 1e3))
        fail(text, form);
    return { Kind::meter, percentile, level };
}

ExposureRule uniform_from_text(const std::string& text)
{
    const std::string form = "random:LOW:HIGH in stops from -64 to 64";
    const auto [low, high] = pair_of(text, form);
    if (!are_stops(low) || !are_stops(high))
        fail(text, form);
    if (low > high)
        fail(text, form + ", LOW not above HIGH");
    return { Kind::uniform, low, high };
}

ExposureRule normal_from_text(const std::string& text)
{
    const std::string form
        = "normal:MEAN:SD in stops, a mean from -64 to 64 and an SD from 0 to 16";
    const auto [mean, sd] = pair_of(text, form);
    if (!are_stops(mean) || !(sd >= 0.0 && sd <= 16.0))
        fail(text, form);
    return { Kind::normal, mean, sd };
}

/// "@p group": {"@p name": [[0, -1.2], ... [1, 3.4]]} of a file of cg2raw match.
Quantiles quantiles_of(const JsonTree& root, const char* group, const char* name)
{
    const std::string where = std::string(group) + "." + name;
    const JsonTree* const parent = root.find(group);
    const JsonTree* const listed
        = parent && parent->is_object() ? parent->find(name) : nullptr;
    if (!listed || !listed->is_array())
        throw Error("has no " + where);
    Quantiles quantiles;
    for (const JsonTree& one : listed->items()) {
        if (!one.is_array() || one.items().size() != 2)
            throw Error(where + " must be pairs of a probability and stops");
        const std::array<double, 2> pair { one.items()[0].number(),
                                           one.items()[1].number() };
        const bool rises = quantiles.empty()
            ? pair[0] == 0.0
            : pair[0] > quantiles.back()[0] && pair[1] >= quantiles.back()[1];
        if (!rises || !are_stops(pair[1]))
            throw Error(where
                        + " must rise, from probability 0 to 1, within -64 to 64 "
                          "stops");
        quantiles.push_back(pair);
    }
    if (quantiles.size() < 2 || quantiles.back()[0] != 1.0)
        throw Error(where + " must rise from probability 0 to 1");
    return quantiles;
}

/// Of "FILE", or of "FILE:draw".
ExposureRule matched_from_text(const std::string& text)
{
    constexpr std::string_view draw = ":draw";
    constexpr double median = 50.0;
    const bool is_drawn = text.size() > draw.size()
        && text.compare(text.size() - draw.size(), draw.size(), draw) == 0;
    const std::string file = text.substr(0, text.size() - (is_drawn ? draw.size() : 0));
    const std::string remedy = "give a file that cg2raw match wrote";
    const auto check_size = [&](std::uintmax_t size) {
        if (size > largest_match)
            throw Error(file + ": has more than 1 MiB: " + remedy);
    };
    const std::string words = read_text_file(path_of(file), remedy, check_size);
    try {
        const JsonTree root = JsonTree::parse(words);
        const JsonTree* const sensor = root.is_object() ? root.find("sensor") : nullptr;
        if (!sensor || !sensor->is_string())
            throw Error("names no sensor");
        if (is_drawn)
            return { Kind::drawn_match,
                     0.0,
                     0.0,
                     quantiles_of(root, "exposure", "quantiles"),
                     {},
                     sensor->text() };
        return { Kind::matched,
                 median,
                 0.0,
                 quantiles_of(root, "levels", "captures"),
                 quantiles_of(root, "levels", "renders"),
                 sensor->text() };
    } catch (const Error& error) {
        throw Error(file + ": " + error.what() + ": " + remedy);
    }
}

ExposureRule rule_from_text(const std::string& text)
{
    const std::string word = lower_case(text.substr(0, text.find(':')));
    if (text.size() == word.size() && word == "auto")
        return { Kind::meter, usual_percentile, usual_level };
    if (word == "auto")
        return meter_from_text(text);
    if (word == "random")
        return uniform_from_text(text);
    if (word == "normal")
        return normal_from_text(text);
    if (word == "match" && text.size() > 6)
        return matched_from_text(text.substr(6));
    const double stops = signed_number(text);
    if (!are_stops(stops))
        fail(text, allowed);
    return { Kind::stops, stops };
}

} // namespace

ExposureRule exposure_from_text(const std::string& text)
{
    ExposureRule rule = rule_from_text(text);
    rule.text = text;
    return rule;
}

double seconds_from_text(std::string_view text)
{
    const double seconds = number_or_fraction(text);
    if (!(seconds > 0.0 && seconds <= 1e6))
        throw Error("\"" + quotable(text)
                    + "\" must be seconds above 0, up to 1000000, such as 0.5 or 1/60");
    return seconds;
}

Limits limits_from_text(const std::string& text)
{
    const std::vector<std::string> words = split(text, ':');
    try {
        if (words.size() == 2)
            if (const Limits limits { seconds_from_text(words[0]),
                                      seconds_from_text(words[1]) };
                limits.low <= limits.high)
                return limits;
        throw Error("no pair that rises");
    } catch (const Error&) {
        throw Error("\"" + quotable(text)
                    + "\" must be LOW:HIGH, numbers above 0, LOW not above HIGH");
    }
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The illuminant grammar.
#include "illuminant_spec.h"

#include "platform/numbers.h"
#include "text.h"

#include <cmath>

namespace cg2raw {

const char* const illuminant_grammar = "A, D50, D55, D65, D75, 3200K (1667K to "
                                       "25000K), xy:0.3457:0.3585, neutral:0.55:0.45 "
                                       "(R/G and B/G), sample:7, measured:7, as-shot, "
                                       "FL2 or lamp:NAME (lamps of the sensor's "
                                       "profile)";

namespace {

using Kind = IlluminantSpec::Kind;

struct NamedLight {
    const char* name;
    Chromaticity xy;
};

/// Four digits, as IEC 61966-2-1 and the DNG specification print them. Source: CIE 015.
constexpr NamedLight named_lights[] = {
    { "a", { 0.4476, 0.4074 } },   { "d50", { 0.3457, 0.3585 } },
    { "d55", { 0.3324, 0.3474 } }, { "d65", { 0.3127, 0.3290 } },
    { "d75", { 0.2990, 0.3149 } },
};

[[noreturn]] void fail(std::string_view spec, const std::string& why)
{
    throw Error("illuminant \"" + std::string(spec) + "\" " + why
                + "; it may be: " + illuminant_grammar);
}

[[noreturn]] void fail_unknown(std::string_view spec)
{
    throw Error("unknown illuminant \"" + std::string(spec)
                + "\"; it may be: " + illuminant_grammar);
}

IlluminantSpec pair_spec(Kind kind, std::string_view spec,
                         const std::vector<std::string>& parts)
{
    if (parts.size() != 3)
        fail(spec, "needs two numbers");
    const double a = number_in(parts[1]), b = number_in(parts[2]);
    const bool xy = kind == Kind::xy;
    if (xy && !(a > 0.0 && b >= 0.01 && a + b < 1.0))
        fail(spec, "is no chromaticity (x above 0, y at least 0.01, x + y below 1)");
    if (!xy && !(a >= 0.01 && a <= 100.0 && b >= 0.01 && b <= 100.0))
        fail(spec, "is no neutral (each number 0.01 to 100)");
    return { kind, a, b };
}

IlluminantSpec kelvin_spec(std::string_view spec, const std::string& word)
{
    const double kelvin = number_in(word.substr(0, word.size() - 1));
    if (std::isnan(kelvin))
        fail_unknown(spec);
    if (!(kelvin >= 1667.0 && kelvin <= 25000.0))
        fail(spec, "is outside 1667 K to 25000 K");
    return { Kind::kelvin, kelvin };
}

constexpr std::uint32_t last_draw = 2147483647;

IlluminantSpec drawn_spec(Kind kind, std::string_view spec,
                          const std::vector<std::string>& parts)
{
    const double index = parts.size() == 2 ? number_in(parts[1]) : -1.0;
    if (!(index >= 0.0 && index == std::floor(index)))
        fail(spec, "needs a whole number, as in " + parts[0] + ":7");
    if (index > double(last_draw))
        fail(spec, "is beyond the last draw, " + std::to_string(last_draw));
    return { kind, 0.0, 0.0, std::uint32_t(index) };
}

/// The CIE's names of fluorescent, LED and high pressure lamps, as in FL2, LED-B3, HP1;
/// an alias has '_' or '.' for '-'. Source: CIE 015, tables 10 to 12.
bool is_lamp_name(const std::string& word)
{
    const auto digit_at = [&](std::size_t i) {
        return word.size() > i && word[i] >= '0' && word[i] <= '9';
    };
    const std::string start = word.substr(0, 2);
    if (start == "fl" || start == "hp")
        return digit_at(2);
    return word.size() > 4 && word.substr(0, 3) == "led"
        && std::string_view("-_.").find(word[3]) != std::string_view::npos;
}

IlluminantSpec lamp_spec(std::string_view spec, const std::string& name)
{
    if (name.empty())
        fail(spec, "needs the name of a lamp, as in lamp:FL2");
    return { Kind::lamp, 0.0, 0.0, 0, name };
}

/// Words of a list of lights: draws can be named by the million.
constexpr std::size_t most_words = 100000;

/// "sample:0-9" -> its ten words, "measured:0-9" too; any other word alone.
void append_words(const std::string& word, std::vector<std::string>& words)
{
    const auto parts = split(word, ':');
    const auto ends = split(parts.back(), '-');
    const std::string draws = lower_case(parts[0]);
    if ((draws != "sample" && draws != "measured") || parts.size() != 2
        || ends.size() != 2) {
        parse_illuminant(word);
        words.push_back(word);
        return;
    }
    const auto first = parse_illuminant(draws + ":" + ends[0]).index;
    const auto last = parse_illuminant(draws + ":" + ends[1]).index;
    if (last < first)
        fail(word,
             "must rise, as " + draws + ":" + std::to_string(last) + "-"
                 + std::to_string(first));
    if (const std::uint32_t more = last - first; more >= most_words)
        fail(word,
             "names " + std::to_string(std::uint64_t(more) + 1)
                 + " draws; a list has at most " + std::to_string(most_words));
    for (auto index = first; index <= last; ++index)
        words.push_back(draws + ":" + std::to_string(index));
}

} // namespace

IlluminantSpec parse_illuminant(std::string_view spec)
{
    const std::string word = lower_case(spec);
    for (const NamedLight& light : named_lights)
        if (word == light.name)
            return { Kind::xy, light.xy.x, light.xy.y };
    if (word == "as-shot")
        return { Kind::as_shot };
    const auto parts = split(word, ':');
    if (parts[0] == "xy")
        return pair_spec(Kind::xy, spec, parts);
    if (parts[0] == "neutral")
        return pair_spec(Kind::neutral, spec, parts);
    if (parts[0] == "sample")
        return drawn_spec(Kind::sample, spec, parts);
    if (parts[0] == "measured")
        return drawn_spec(Kind::measured, spec, parts);
    if (parts[0] == "lamp" && parts.size() == 2)
        return lamp_spec(spec, parts[1]);
    if (is_lamp_name(word))
        return lamp_spec(spec, word);
    if (word.size() > 1 && word.back() == 'k')
        return kelvin_spec(spec, word);
    fail_unknown(spec);
}

std::vector<std::string> illuminant_list(std::string_view list)
{
    std::vector<std::string> words;
    for (const std::string& word : split(list, ',')) {
        append_words(word, words);
        if (words.size() > most_words)
            throw Error("a list of more than " + std::to_string(most_words)
                        + " illuminants, as of \"" + word
                        + "\" on, is too long: give fewer");
    }
    return words;
}

} // namespace cg2raw

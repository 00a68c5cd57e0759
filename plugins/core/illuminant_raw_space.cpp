// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Names of RAW colour spaces: what a pixel that is already camera RGB is called.
#include "cg2raw/illuminant.h"

#include "illuminant_spec.h"
#include "text.h"

#include <algorithm>
#include <cstdlib>

namespace cg2raw {
namespace {

std::string aliased(std::string_view text)
{
    std::string alias = lower_case(text);
    for (char& c : alias)
        if (c == '-' || c == ':' || c == '.' || c == ' ')
            c = '_';
    return alias;
}

/// "neutral:1:0.5" as "neutral:1.0:0.5": then each number has two parts in an alias.
std::string with_fractions(const std::string& illuminant)
{
    const auto parts = split(illuminant, ':');
    if (parts.size() != 3) // only xy: and neutral: have two numbers
        return illuminant;
    std::string word = parts[0];
    for (std::size_t i = 1; i < parts.size(); ++i)
        word += ":" + parts[i] + (parts[i].find('.') == std::string::npos ? ".0" : "");
    return word;
}

/// The word whose alias is @p alias: "sample_7" -> "sample:7", "xy_0_3_0_4" ->
/// "xy:0.3:0.4".
std::string illuminant_from_alias(const std::string& alias)
{
    const auto parts = split(alias, '_');
    if (parts.size() == 5 && (parts[0] == "xy" || parts[0] == "neutral"))
        return parts[0] + ":" + parts[1] + "." + parts[2] + ":" + parts[3] + "."
            + parts[4];
    if (parts.size() == 2 && (parts[0] == "sample" || parts[0] == "measured"))
        return parts[0] + ":" + parts[1];
    if (parts.size() > 1 && parts[0] == "lamp")
        return "lamp:" + alias.substr(5);
    if (alias == "as_shot")
        return "as-shot";
    std::string word = parts[0]; // "2856k", or "2856_5k" for 2856.5K
    for (std::size_t i = 1; i < parts.size(); ++i)
        word += "." + parts[i];
    return word;
}

std::string trimmed(std::string_view text)
{
    const auto first = text.find_first_not_of(' ');
    const auto last = text.find_last_not_of(' ');
    return first == text.npos ? "" : std::string(text.substr(first, last - first + 1));
}

/// The words "<sensor>_<illuminant>" of an alias.
std::optional<RawSpace> from_alias(const std::string& name,
                                   const std::vector<std::string>& sensors)
{
    std::optional<RawSpace> best; // the longest id wins: sony-a7 and sony-a7-ii
    for (const std::string& sensor : sensors) {
        const std::string prefix = aliased(sensor) + "_";
        if (name.compare(0, prefix.size(), prefix) == 0
            && (!best || sensor.size() > best->sensor.size()))
            best = RawSpace { sensor,
                              illuminant_from_alias(name.substr(prefix.size())) };
    }
    return best;
}

/// What a name says after @p prefix; nothing if it starts otherwise.
std::optional<std::string> after(const std::string& name, std::string_view prefix)
{
    if (lower_case(name.substr(0, prefix.size())) != prefix)
        return std::nullopt;
    return name.substr(prefix.size());
}

/// The words "<sensor> - <illuminant>".
RawSpace from_words(const std::string& words, const std::string& name)
{
    const auto gap = words.find(" - ");
    if (gap == words.npos)
        throw Error("colour space \"" + name
                    + "\" must be named RAW - <sensor> - <illuminant>");
    return { lower_case(trimmed(words.substr(0, gap))),
             trimmed(words.substr(gap + 3)) };
}

/// The space that the environment chooses, in a config of context variables.
RawSpace from_environment(const std::string& name)
{
    const char* const sensor = std::getenv("CG2RAW_SENSOR");
    const char* const illuminant = std::getenv("CG2RAW_ILLUMINANT");
    if (!sensor || !*sensor || !illuminant || !*illuminant)
        throw Error("colour space \"" + name
                    + "\" is that of the environment: set CG2RAW_SENSOR and"
                      " CG2RAW_ILLUMINANT to a sensor's id and an illuminant");
    return { sensor, illuminant };
}

/// A name without the namespace that an interop ID has: of "cg2raw:raw_..." "raw_...".
std::string without_namespace(std::string_view name)
{
    const auto end = name.rfind(':'); // no alias holds one
    const std::string_view last = end == name.npos ? name : name.substr(end + 1);
    return std::string(after(std::string(last), "raw_") ? last : name);
}

std::optional<RawSpace> named_space(const std::string& name,
                                    const std::vector<std::string>& sensors)
{
    const std::string lower = lower_case(name);
    for (const char* context : { "raw - context", "raw_context",
                                 "raw unbounded - context", "raw_unbounded_context" })
        if (lower == context)
            return from_environment(name);
    for (const char* prefix : { "raw - ", "raw unbounded - " })
        if (const auto words = after(name, prefix))
            return from_words(*words, name);
    // The longer prefix first: raw_ is the start of both.
    for (const char* prefix : { "raw_unbounded_", "raw_" })
        if (const auto words = after(lower, prefix)) {
            if (const auto space = from_alias(*words, sensors))
                return space;
            throw Error("colour space \"" + name
                        + "\" names none of the installed sensors: " + joined(sensors));
        }
    return std::nullopt;
}

} // namespace

std::optional<RawSpace> raw_space_from_name(std::string_view name,
                                            const std::vector<std::string>& sensors)
{
    const auto space = named_space(without_namespace(trimmed(name)), sensors);
    if (space)
        parse_illuminant(space->illuminant);
    return space;
}

std::string raw_space_name(const RawSpace& space)
{
    return "RAW - " + space.sensor + " - " + space.illuminant;
}

std::string raw_space_alias(const RawSpace& space)
{
    return "raw_" + aliased(space.sensor) + "_"
        + aliased(with_fractions(space.illuminant));
}

std::string raw_space_interop_id(const RawSpace& space)
{
    return "cg2raw:" + raw_space_alias(space);
}

std::string space_of_file(std::string_view space, std::string_view interop_id)
{
    const bool is_stated = !space.empty() && space != "Linear";
    const bool is_raw = after(without_namespace(interop_id), "raw_").has_value();
    return std::string(is_raw && !is_stated ? interop_id : space);
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "targets.h"

#include "cg2raw/illuminant.h"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace cg2raw::test {
namespace {

const std::string colors = R"({
    "schema": 1, "id": "fuzz", "make": "b", "model": "c", "unique_camera_model": "d",
    "sources": {}, "cfa": "RGGB", "width": 64, "height": 48, "bits": 14,
    "black_level": 512, "white_level": 16383, "calibration_illuminant_1": "A",
    "color_matrix_1": [0.8, -0.2, -0.08, -0.4, 1.2, 0.22, -0.08, 0.18, 0.6],
    "calibration_illuminant_2": "D65",
    "color_matrix_2": [0.7, -0.08, -0.1, -0.44, 1.26, 0.2, -0.08, 0.2, 0.58],
    "illuminants": { "neutrals": [[0.9, 0.3], [0.5, 0.6], [0.7, 0.35], [0.45, 0.75]] },
    "lamps": [{ "name": "my-lamp", "neutral": [0.5, 0.6], "color_matrix":
        [0.8, -0.2, -0.08, -0.4, 1.2, 0.22, -0.08, 0.18, 0.6] }]
})";
const std::string grey = R"({
    "schema": 1, "id": "grey", "make": "b", "model": "c", "unique_camera_model": "e",
    "sources": {}, "cfa": "mono", "width": 64, "height": 48, "bits": 14,
    "black_level": 512, "white_level": 16383
})";

SensorProfile seeing_profile()
{
    SensorProfile profile = parse_profile(colors, "colors.json");
    SpectralSensitivities lobes;
    for (int nm = 380; nm <= 780; nm += 20) {
        const double along = (nm - 380) / 400.0;
        lobes.wavelengths.push_back(nm);
        lobes.rgb.push_back({ along, 4 * along * (1 - along), 1 - along });
    }
    profile.spectral_sensitivities = lobes;
    return profile;
}

/// Runs @p read, whose Error gets the name that bounded() wants.
template <class Read> bool accepted(std::string_view bytes, const Read& read)
{
    const auto named = [&] {
        try {
            read();
        } catch (const Error& error) {
            throw Error("fuzz: " + std::string(error.what()));
        }
    };
    return bounded(named, bytes.size(), illuminant_memory, "fuzz");
}

/// The neutral of @p word; nothing if it is refused.
std::optional<Vec3> neutral_of(const SensorProfile& profile, std::string_view word)
{
    try {
        return illuminant(profile, word).neutral;
    } catch (const Error&) {
        return std::nullopt;
    }
}

void check_alike(const SensorProfile& profile, const std::string& word,
                 const std::optional<Vec3>& neutral, const std::string& other)
{
    if (neutral_of(profile, other) != neutral)
        throw Finding("\"" + word + "\" is another light than \"" + other + "\"");
}

/// A word says the same in upper case; in the name of a colour space, and in the alias
/// of that, the same or nothing.
void use_word(const SensorProfile& profile, const std::string& word)
{
    const auto neutral = neutral_of(profile, word);
    for (const double channel : neutral.value_or(Vec3 { 0, 0, 0 }))
        if (!(channel > 0.0 && std::isfinite(channel)))
            throw Finding("a neutral is not above 0");
    std::string capitals = word;
    std::transform(capitals.begin(), capitals.end(), capitals.begin(),
                   [](unsigned char c) { return char(std::toupper(c)); });
    check_alike(profile, word, neutral, capitals);
    const RawSpace space { profile.id, word };
    for (const std::string& name : { raw_space_name(space), raw_space_alias(space) })
        try {
            const auto named = raw_space_from_name(name, { profile.id }).value();
            check_alike(profile, word, neutral, named.illuminant);
        } catch (const Error&) { // a lamp without "lamp:", the alias of neutral:5e-1:1
        }
}

void use_spectrum(const SensorProfile& profile, const std::string& word)
{
    const LightSpectrum light = spectrum_of(profile, illuminant(profile, word));
    for (const double power : light.power.values)
        if (!(power >= 0.0 && std::isfinite(power)))
            throw Finding("the power of a light is not finite, or below 0");
}

bool fuzz_word(std::string_view bytes)
{
    static const SensorProfile profile = seeing_profile();
    static const SensorProfile mono = parse_profile(grey, "grey.json");
    const bool is_grey = accepted(bytes, [&] { illuminant(mono, bytes); });
    if (!accepted(bytes, [&] { illuminant(profile, bytes); }))
        return is_grey;
    const std::string word(bytes);
    if (word.find(':') == word.npos) // else it may be the nearest of hundreds: slow
        use_spectrum(profile, word);
    use_light(profile, word.c_str());
    // What stands around a word in a space's name does not count.
    if (word.front() != ' ' && word.back() != ' ')
        use_word(profile, word);
    return true;
}

bool fuzz_list(std::string_view bytes)
{
    std::vector<std::string> words;
    if (!accepted(bytes, [&] { words = illuminant_list(bytes); }))
        return false;
    if (words.empty())
        throw Finding("a list of no light");
    for (const std::string& word : { words.front(), words.back() })
        if (illuminant_list(word) != std::vector { word })
            throw Finding("a word of a list is no word: " + word);
    return true;
}

bool fuzz_space(std::string_view bytes)
{
    std::optional<RawSpace> space;
    const auto read = [&] {
        space = raw_space_from_name(bytes, { "fuzz", "fuzz-b", "a.b-c" });
    };
    return accepted(bytes, read) && space;
}

} // namespace

bool fuzz_illuminant(std::string_view bytes)
{
    const bool is_word = fuzz_word(bytes), is_list = fuzz_list(bytes);
    return fuzz_space(bytes) || is_word || is_list;
}

} // namespace cg2raw::test

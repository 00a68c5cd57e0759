// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Which channels of a render are its picture.
#include "cg2raw/scene_file.h"

#include "cg2raw/types.h"
#include "text.h"

#include <algorithm>
#include <iterator>
#include <unordered_map>

namespace cg2raw {
namespace {

/// What renderers and compositors call the picture.
constexpr const char* beauty_names[]
    = { "rgba", "rgb", "beauty", "c", "ci", "combined" };
/// What Nuke calls the layer of channels without one.
constexpr const char* unnamed = "rgba";
/// Letters of red, green and blue; what else renderers call the channels of three.
struct Letters {
    const char* names[3][2];
};
constexpr Letters rgb { { { "r", "red" }, { "g", "green" }, { "b", "blue" } } };
constexpr const char* alpha_names[] = { "a", "alpha" };
constexpr Letters others[] = { { { { "x", "x" }, { "y", "y" }, { "z", "z" } } },
                               { { { "0", "0" }, { "1", "1" }, { "2", "2" } } } };
/// Words in the names of layers that are no pictures, and names that are one of these.
constexpr const char* data_parts[]
    = { "crypto", "normal", "motion", "velocity", "depth", "denoising" };
constexpr const char* data_words[] = { "id",
                                       "ids",
                                       "uv",
                                       "st",
                                       "mv",
                                       "vector",
                                       "vectors",
                                       "tangent",
                                       "position",
                                       "positions",
                                       "pref",
                                       "indexob",
                                       "indexma",
                                       "objectid",
                                       "materialid",
                                       "pworld",
                                       "worldposition",
                                       "n",
                                       "nn",
                                       "p",
                                       "pn",
                                       "z" };
/// Names of channels or layers that a message lists.
constexpr std::size_t most_listed = 40;

std::string last_word(const std::string& name)
{
    return lower_case(name.substr(name.rfind('.') + 1));
}

bool is_beauty_name(const std::string& name)
{
    const auto is_it = [&](const char* known) { return name == known; };
    return std::any_of(std::begin(beauty_names), std::end(beauty_names), is_it);
}

/// 0, 1, 2 of a channel that is the first, second or third of @p letters, 3 of
/// alpha; -1 of others.
int color_of(const std::string& channel, const Letters& letters)
{
    const std::string word = last_word(channel);
    for (int color = 0; color < 3; ++color)
        for (const char* name : letters.names[color])
            if (word == name)
                return color;
    for (const char* name : alpha_names)
        if (word == name)
            return 3;
    return -1;
}

/// The words of a name, in lower case: they end at capitals and at what is no letter.
std::vector<std::string> words_in(const std::string& name)
{
    std::vector<std::string> words(1);
    bool was_lower = false;
    for (const char letter : name) {
        const bool is_lower = letter >= 'a' && letter <= 'z';
        const bool is_upper = letter >= 'A' && letter <= 'Z';
        if ((!is_lower && !is_upper) || (is_upper && was_lower))
            words.emplace_back();
        if (is_lower || is_upper)
            words.back() += letter;
        was_lower = is_lower;
    }
    for (std::string& word : words)
        word = lower_case(word);
    return words;
}

/// Whether a layer's name says that it holds no picture.
bool is_data(const SceneLayer& layer, const LayerHints& hints)
{
    const std::string lower = lower_case(layer.name);
    const auto starts = [&](const std::string& name) {
        return !name.empty() && lower.compare(0, name.size(), lower_case(name)) == 0;
    };
    const auto has = [&](const char* part) { return lower.find(part) != lower.npos; };
    const auto is_word = [](const std::string& word) {
        return std::find(std::begin(data_words), std::end(data_words), word)
            != std::end(data_words);
    };
    const auto words = words_in(layer.name);
    return std::any_of(hints.data.begin(), hints.data.end(), starts)
        || std::any_of(std::begin(data_parts), std::end(data_parts), has)
        || is_word(last_word(layer.name))
        || std::any_of(words.begin(), words.end(), [&](const std::string& word) {
               return word.size() > 1 && is_word(word);
           });
}

/// What stands before the last dot.
std::string prefix_of(const std::string& channel)
{
    const auto dot = channel.rfind('.');
    return dot == std::string::npos ? "" : channel.substr(0, dot);
}

/// OpenImageIO calls channels without a name channel0, channel1 ...
bool is_unnamed(const std::string& channel)
{
    return channel.empty() || lower_case(channel).compare(0, 7, "channel") == 0;
}

/// "part.layer", either of them, or nothing.
std::string full_name(const std::string& part, const std::string& layer)
{
    if (part.empty() || layer.empty() || lower_case(part) == lower_case(layer))
        return layer.empty() ? part : layer;
    const std::string start = lower_case(part) + ".";
    if (lower_case(layer).compare(0, start.size(), start) == 0)
        return layer; // the channels repeat their part's name
    return part + "." + layer;
}

bool are_unnamed(const std::vector<std::string>& channels)
{
    return channels.size() >= 3
        && std::all_of(channels.begin(), channels.begin() + 3, is_unnamed);
}

/// The layers of one part that have all three @p letters, in the file's order.
std::vector<SceneLayer> layers_of(const std::vector<std::string>& channels,
                                  const std::string& part, int index,
                                  const Letters& letters)
{
    std::vector<SceneLayer> found;
    std::unordered_map<std::string, std::size_t> places; ///< in found, by prefix
    for (std::size_t i = 0; i < channels.size(); ++i) {
        const int color = color_of(channels[i], letters);
        if (color < 0)
            continue;
        const std::string prefix = prefix_of(channels[i]);
        const auto [place, is_new] = places.try_emplace(prefix, found.size());
        if (is_new)
            found.push_back({ full_name(part, prefix), index, { -1, -1, -1 } });
        SceneLayer& layer = found[place->second];
        int& channel = color == 3 ? layer.alpha : layer.channels[std::size_t(color)];
        channel = channel < 0 ? int(i) : channel;
    }
    const auto is_incomplete = [](const SceneLayer& layer) {
        return *std::min_element(layer.channels.begin(), layer.channels.end()) < 0;
    };
    found.erase(std::remove_if(found.begin(), found.end(), is_incomplete), found.end());
    if (found.empty() && channels.size() <= 4 && are_unnamed(channels))
        found.push_back({ part, index, { 0, 1, 2 }, channels.size() == 4 ? 3 : -1 });
    return found;
}

/// "a, b, c and 17 more"
std::string listed(std::vector<std::string> words)
{
    const std::size_t count = words.size();
    words.resize(std::min(count, most_listed));
    return joined(words)
        + (count > most_listed ? " and " + std::to_string(count - most_listed) + " more"
                               : "");
}

std::string part_name(const std::vector<ScenePart>& parts, std::size_t index)
{
    const std::string& name = parts[index].name;
    return name.empty() ? std::to_string(index) : name;
}

std::string channels_of(const std::vector<ScenePart>& parts)
{
    std::vector<std::string> names;
    for (std::size_t i = 0; i < parts.size(); ++i)
        for (const std::string& channel : parts[i].channels)
            names.push_back((parts.size() > 1 ? part_name(parts, i) + ":" : "")
                            + (channel.empty() ? "(no name)" : channel));
    return names.empty() ? "no channels" : "the channels " + listed(names);
}

/// A name as a shell takes it for one word.
std::string quoted(const std::string& name)
{
    constexpr const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                  "0123456789._-+,:/@%=";
    if (name.find_first_not_of(plain) == name.npos)
        return name;
    std::string text = "\"";
    for (const char letter : name)
        text += (std::string_view("\"\\$`").find(letter) == std::string_view::npos
                     ? ""
                     : "\\")
            + std::string(1, letter);
    return text + "\"";
}

std::string names_of(const std::vector<SceneLayer>& layers)
{
    std::vector<std::string> names;
    for (const SceneLayer& layer : layers)
        names.push_back(quoted(layer.name.empty() ? unnamed : layer.name));
    return listed(names);
}

/// The one of @p layers that @p is_it; nothing if there is none or several.
template <class Test>
const SceneLayer* only(const std::vector<SceneLayer>& layers, const Test& is_it)
{
    const auto first = std::find_if(layers.begin(), layers.end(), is_it);
    if (first == layers.end()
        || std::find_if(first + 1, layers.end(), is_it) != layers.end())
        return nullptr;
    return &*first;
}

const SceneLayer* conventional(const std::vector<SceneLayer>& layers)
{
    if (const auto* found
        = only(layers, [](const SceneLayer& layer) { return layer.name.empty(); }))
        return found;
    if (const auto* found = only(layers, [](const SceneLayer& layer) {
            return is_beauty_name(lower_case(layer.name));
        }))
        return found;
    return only(layers, [](const SceneLayer& layer) {
        return is_beauty_name(last_word(layer.name));
    });
}

/// Whether a file has nothing but one picture and its alpha.
bool is_plain(const std::vector<ScenePart>& parts, const LayerHints& hints)
{
    return parts.size() == 1 && parts[0].channels.size() <= 4 && !hints.other_parts;
}

/// All layers of a file; those of several parts begin with the part's name.
std::vector<SceneLayer> all_layers(const std::vector<ScenePart>& parts,
                                   bool has_siblings, const Letters& letters = rgb)
{
    std::vector<SceneLayer> layers;
    for (std::size_t i = 0; i < parts.size(); ++i)
        for (SceneLayer& layer :
             layers_of(parts[i].channels, has_siblings ? part_name(parts, i) : "",
                       int(i), letters))
            layers.push_back(std::move(layer));
    return layers;
}

/// The layers that @p asked may name: of red, green and blue, and of other letters.
std::vector<SceneLayer> all_triples(const std::vector<ScenePart>& parts,
                                    bool has_siblings)
{
    auto layers = all_layers(parts, has_siblings);
    for (const Letters& letters : others)
        for (SceneLayer& layer : all_layers(parts, has_siblings, letters)) {
            const auto is_known = [&](const SceneLayer& known) {
                return known.name == layer.name && known.part == layer.part;
            };
            if (std::none_of(layers.begin(), layers.end(), is_known))
                layers.push_back(std::move(layer));
        }
    return layers;
}

bool is_rgb(const std::vector<ScenePart>& parts, const SceneLayer& layer)
{
    const auto& channels = parts[std::size_t(layer.part)].channels;
    const std::string& first = channels[std::size_t(layer.channels[0])];
    return is_unnamed(first) || color_of(first, rgb) == 0;
}

/// What oiiotool takes a layer's channels by.
std::string by_channels(const std::vector<ScenePart>& parts, const SceneLayer& layer)
{
    std::string names;
    for (const int channel : layer.channels)
        names += (names.empty() ? "" : ",")
            + parts[std::size_t(layer.part)].channels[std::size_t(channel)];
    return "oiiotool --ch " + quoted(names) + " --chnames R,G,B";
}

[[noreturn]] void fail(const std::vector<ScenePart>& parts, bool has_siblings,
                       const LayerHints& hints)
{
    std::vector<SceneLayer> pictures, data;
    std::string by_name = "oiiotool --ch NAME,NAME,NAME --chnames R,G,B";
    for (const SceneLayer& layer : all_triples(parts, has_siblings))
        if (layer.name.empty() && !is_rgb(parts, layer))
            by_name = by_channels(parts, layer);
        else
            (is_data(layer, hints) ? data : pictures).push_back(layer);
    const std::string has = "has " + channels_of(parts);
    const std::string rest = (data.empty() ? "" : "; data: " + names_of(data))
        + (hints.other_parts
               ? "; the file has other parts, which oiiotool --subimage NAME takes"
               : "");
    if (pictures.empty() && data.empty())
        throw Error("needs R, G and B of one layer, " + has
                    + " (if three of them are: " + by_name + ")" + rest);
    if (pictures.empty())
        throw Error("needs R, G and B of a picture, and its layers are data by their "
                    "names; it "
                    + has + rest);
    const SceneLayer& first = pictures[0];
    const std::string name = quoted(first.name.empty() ? unnamed : first.name);
    const std::string add = hints.option(name)
        + (is_rgb(parts, first) ? "" : " (or " + by_channels(parts, first) + ")");
    if (pictures.size() == 1)
        throw Error("is its layer " + name + " the picture? Then add " + add + "; it "
                    + has + rest);
    throw Error("which of its layers is the picture? Add " + add + ", or another of "
                + names_of(pictures) + "; it " + has + rest);
}

/// The layer of a name, or of the end of one.
const SceneLayer* named(const std::vector<SceneLayer>& layers, const std::string& name)
{
    const std::string lower = lower_case(name), end = "." + lower;
    if (const auto* found = only(layers, [&](const SceneLayer& layer) {
            return lower_case(layer.name.empty() ? unnamed : layer.name) == lower;
        }))
        return found;
    return only(layers, [&](const SceneLayer& layer) {
        const std::string whole = lower_case(layer.name);
        return whole.size() > end.size()
            && whole.compare(whole.size() - end.size(), end.size(), end) == 0;
    });
}

SceneLayer asked_layer(const std::vector<ScenePart>& parts, const std::string& asked,
                       bool has_siblings, const LayerHints& hints)
{
    const auto layers = all_triples(parts, has_siblings);
    if (const SceneLayer* found = named(layers, asked))
        return *found;
    // A part that was taken out of its file keeps its name.
    const auto with_parts = all_triples(parts, true);
    if (const SceneLayer* found = named(with_parts, asked))
        return *found;
    // What a host puts in the place of a missing frame has no names.
    if (parts.size() == 1 && are_unnamed(parts[0].channels))
        return { "", 0, { 0, 1, 2 }, parts[0].channels.size() == 4 ? 3 : -1 };
    throw Error(hints.option(quoted(asked)) + ": no layer of that name has R, G and B; "
                + (layers.empty() ? "none has" : names_of(layers) + " have"));
}

} // namespace

SceneLayer beauty_layer(const std::vector<ScenePart>& parts, std::string_view asked,
                        const LayerHints& hints)
{
    const bool has_siblings = parts.size() > 1 || hints.other_parts;
    if (!asked.empty())
        return asked_layer(parts, std::string(asked), has_siblings, hints);
    const auto layers = all_layers(parts, has_siblings);
    if (layers.size() == 1 && is_plain(parts, hints) && !is_data(layers[0], hints))
        return layers[0];
    const SceneLayer* const found = conventional(layers);
    if (!found)
        fail(parts, has_siblings, hints);
    return *found;
}

} // namespace cg2raw

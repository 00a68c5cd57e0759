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
constexpr const char* color_names[4][2]
    = { { "r", "red" }, { "g", "green" }, { "b", "blue" }, { "a", "alpha" } };
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

/// 0, 1, 2 of a channel that is red, green or blue, 3 of alpha; -1 of others.
int color_of(const std::string& channel)
{
    const std::string word = last_word(channel);
    for (int color = 0; color < 4; ++color)
        if (word == color_names[color][0] || word == color_names[color][1])
            return color;
    return -1;
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

/// The layers of one part that have red, green and blue, in the file's order.
std::vector<SceneLayer> layers_of(const std::vector<std::string>& channels,
                                  const std::string& part, int index)
{
    std::vector<SceneLayer> found;
    std::unordered_map<std::string, std::size_t> places; ///< in found, by prefix
    for (std::size_t i = 0; i < channels.size(); ++i) {
        const int color = color_of(channels[i]);
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
    if (found.empty() && (channels.size() == 3 || channels.size() == 4)
        && std::all_of(channels.begin(), channels.begin() + 3, is_unnamed))
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
                            + channel);
    return listed(names);
}

/// A name as a shell takes it for one word.
std::string quoted(const std::string& name)
{
    return name.find(' ') == name.npos ? name : "\"" + name + "\"";
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
                                   bool has_siblings)
{
    std::vector<SceneLayer> layers;
    for (std::size_t i = 0; i < parts.size(); ++i)
        for (SceneLayer& layer : layers_of(
                 parts[i].channels, has_siblings ? part_name(parts, i) : "", int(i)))
            layers.push_back(std::move(layer));
    return layers;
}

[[noreturn]] void fail(const std::vector<ScenePart>& parts,
                       const std::vector<SceneLayer>& layers, const LayerHints& hints)
{
    const std::string channels = channels_of(parts);
    const std::string others = hints.other_parts
        ? "; the file has other parts, which oiiotool --subimage NAME takes"
        : "";
    if (layers.empty())
        throw Error("needs R, G and B of one layer, has the channels " + channels
                    + " (if three of them are: oiiotool --ch NAME,NAME,NAME --chnames "
                      "R,G,B)"
                    + others);
    const std::string add = hints.option + " " + quoted(layers[0].name);
    if (layers.size() == 1)
        throw Error("is its layer " + quoted(layers[0].name) + " the picture? Then add "
                    + add + "; it has the channels " + channels + others);
    throw Error("which of its layers is the picture? Add " + add + ", or another of "
                + names_of(layers) + "; it has the channels " + channels + others);
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
    const auto layers = all_layers(parts, has_siblings);
    if (const SceneLayer* found = named(layers, asked))
        return *found;
    // A part that was taken out of its file keeps its name.
    const auto with_parts = all_layers(parts, true);
    if (const SceneLayer* found = named(with_parts, asked))
        return *found;
    throw Error(hints.option + " " + quoted(asked)
                + ": no layer of that name has R, G and B; "
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
    if (layers.size() == 1 && is_plain(parts, hints))
        return layers[0];
    const SceneLayer* const found = conventional(layers);
    if (!found)
        fail(parts, layers, hints);
    return *found;
}

} // namespace cg2raw

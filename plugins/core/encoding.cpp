// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Which curve encodes the numbers of a file.
#include "cg2raw/encoding.h"

#include "cg2raw/types.h"
#include "text.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace cg2raw {
namespace {

/// Names of sRGB in OpenImageIO 2 and 3, and in common configs.
constexpr const char* srgb_names[] = { "srgb",
                                       "srgb_rec709_scene",
                                       "srgb_rec709_display",
                                       "srgb_rec709",
                                       "srgb_texture",
                                       "srgb_tx",
                                       "srgb - texture",
                                       "utility - srgb - texture",
                                       "srgb encoded rec.709 (srgb)" };
/// Transfer characteristics of DPX files that say nothing of the curve.
/// Source: SMPTE ST 268-1, in the words of OpenImageIO.
constexpr const char* silent_transfers[] = { "", "undefined", "user defined" };
constexpr const char* needed = "neither scene-linear Rec.709 nor a RAW space";

template <std::size_t n>
bool is_among(const char* const (&names)[n], std::string_view name)
{
    return std::find(std::begin(names), std::end(names), lower_case(name))
        != std::end(names);
}

bool is_integer(const StatedEncoding& said) { return levels_of(said.samples) != 0; }

/// What may be done with pixels that no rule of ours decodes.
std::string remedies(const EncodingWords& words)
{
    return words.is_linear + " if they are linear already, else " + words.convert();
}

std::string in_quotes(const std::string& text) { return '"' + quotable(text) + '"'; }

/// Of pixels that are linear light, or RAW.
Curve no_curve(const StatedEncoding& said, Undo undo, const EncodingWords& words)
{
    if (undo != Undo::srgb)
        return {};
    if (!said.space.empty())
        throw Error(words.linearize + ": its colour space " + in_quotes(said.space)
                    + " has no curve to undo: leave it out");
    throw Error(
        words.linearize
        + ": its floats state no colour space and are linear light by "
          "convention: leave it out, or state their space: --iscolorspace sRGB");
}

/// What a file states beside the name of a space: curves that are not sRGB's.
void refuse_other_curves(const StatedEncoding& said, const EncodingWords& words)
{
    if (!said.icc_profile.empty()
        && lower_case(said.icc_profile).find("srgb") == std::string::npos)
        throw Error("has the ICC profile " + in_quotes(said.icc_profile)
                    + ": convert it to sRGB, or to scene-linear Rec.709; add "
                    + words.is_linear + " if its pixels are that already");
    if (!is_among(silent_transfers, said.transfer))
        throw Error("has the transfer characteristic " + in_quotes(said.transfer)
                    + ", not sRGB's: add " + remedies(words));
}

/// No curve is known to encode whole numbers of another depth.
void refuse_other_depths(const StatedEncoding& said, const EncodingWords& words)
{
    if (levels_of(said.samples) < 0)
        throw Error("has " + said.samples
                    + " samples: needs 8 or 16 bits, or floats; add " + words.is_linear
                    + " if they are linear already");
}

/// Of pixels that sRGB's curve encodes.
Curve srgb_curve(const StatedEncoding& said, Undo undo, const EncodingWords& words)
{
    if (undo == Undo::none)
        throw Error("colour space " + in_quotes(said.space) + " is " + needed + ": add "
                    + words.linearize + ", or " + remedies(words));
    refuse_other_depths(said, words);
    return { Curve::Kind::srgb };
}

/// Of whole numbers whose colour space nobody states.
Curve unstated_curve(const StatedEncoding& said, Undo undo, const EncodingWords& words)
{
    if (!said.icc_profile.empty()) // sRGB's, as others were refused
        return srgb_curve(said, undo, words);
    refuse_other_depths(said, words);
    if (undo == Undo::none || undo == Undo::stated)
        throw Error("its whole numbers state no colour space: add " + words.linearize
                    + " if sRGB's curve encodes them, " + remedies(words));
    return srgb_curve(said, undo, words);
}

} // namespace

Undo undo_from_name(std::string_view name)
{
    constexpr std::pair<const char*, Undo> known[]
        = { { "none", Undo::none },
            { "srgb", Undo::srgb },
            { "stated", Undo::stated },
            { "stated-or-srgb", Undo::stated_or_srgb } };
    for (const auto& [word, undo] : known)
        if (name == word)
            return undo;
    throw Error(in_quotes(std::string(name))
                + " must be none, srgb, stated or stated-or-srgb");
}

std::string Curve::name() const
{
    return kind == Kind::none ? ""
        : kind == Kind::srgb  ? "srgb"
                              : "g" + number(exponent);
}

bool is_srgb_name(std::string_view space) { return is_among(srgb_names, space); }

int levels_of(std::string_view samples)
{
    if (samples == "uint8" || samples == "uint16")
        return samples == "uint8" ? 256 : 65536;
    return samples == "half" || samples == "float" || samples == "double" ? 0 : -1;
}

Curve curve_of(const StatedEncoding& said, Undo undo, const EncodingWords& words)
{
    if (said.is_raw || (said.is_rec709 && !said.space.empty()))
        return no_curve(said, undo, words);
    refuse_other_curves(said, words);
    if (said.space.empty())
        return is_integer(said) ? unstated_curve(said, undo, words)
                                : no_curve(said, undo, words);
    if (is_srgb_name(said.space))
        return srgb_curve(said, undo, words);
    const bool follows = undo == Undo::stated || undo == Undo::stated_or_srgb;
    if (follows && levels_of(said.samples) > 0 && said.gamma > 0.0
        && lower_case(said.space).find("rec709") != std::string::npos)
        // Files state it with four decimals or fewer.
        return { Curve::Kind::power, std::round(said.gamma * 1e4) / 1e4 };
    const std::string start = undo == Undo::srgb ? words.linearize + ": its " : "";
    throw Error(start + "colour space " + in_quotes(said.space) + " is " + needed
                + (start.empty() ? "" : ", nor sRGB") + ": add " + remedies(words));
}

} // namespace cg2raw

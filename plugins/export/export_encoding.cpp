// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What the numbers of an image mean, as its metadata say it.
#include "rules.h"

#include "cg2raw/color.h"
#include "core/text.h"

#include <algorithm>
#include <array>

namespace cg2raw {
namespace {

/// What the words "linear" and "scene_linear" stand for is the OCIO config's business;
/// without one they are Rec.709.
bool is_rec709(const Given& given, const std::string& space)
{
    const std::string word = lower_case(space);
    if (word == "linear" || word == "scene_linear")
        return given.dialect.is_rec709(word);
    return space.empty() || is_rec709_name(space);
}

/// OpenEXR files may say their primaries themselves.
void require_rec709_primaries(const Given& given, const ImagePart& part,
                              const std::string& space)
{
    const Metadata::Value* const said = part.metadata.find("chromaticities");
    const auto* const numbers = said ? std::get_if<Metadata::Numbers>(said) : nullptr;
    std::array<double, 8> chromaticities {};
    if (!numbers || numbers->values.size() != chromaticities.size())
        return;
    std::copy(numbers->values.begin(), numbers->values.end(), chromaticities.begin());
    if (!is_rec709_primaries(chromaticities)) // what a config says costs time
        cg2raw::require_rec709_primaries(chromaticities, space,
                                         given.facts.openimageio_version,
                                         given.dialect.rec709());
}

/// The words of a remedy: from a space that is stated or not, to Rec.709.
std::string to_rec709(const Dialect& dialect, bool is_stated)
{
    // A host takes what states no space for linear light.
    const std::string from = is_stated ? "" : "--iscolorspace NAME ";
    if (dialect.converts)
        return from + "--tocolorspace \"" + dialect.rec709()
            + "\" (or \"RAW - <sensor> - <illuminant>\") before -o";
    return "oiiotool " + from + "--tocolorspace " + dialect.rec709();
}

StatedEncoding stated_encoding(const Given& given, const ImagePart& part, bool is_raw)
{
    StatedEncoding said;
    said.space = color_space(given, part);
    said.is_rec709 = is_rec709(given, said.space);
    said.is_raw = is_raw;
    said.samples = part.samples;
    said.icc_profile = part.metadata.text("ICCProfile:profile_description");
    said.transfer = part.metadata.text("dpx:Transfer");
    said.gamma = part.metadata.number("oiio:Gamma");
    return said;
}

/// "oiio:UnassociatedAlpha" is what readers state of pixels that are as in the file;
/// by default they multiply colour by alpha.
Alpha alpha(const ImagePart& part, const SceneLayer& layer)
{
    if (layer.alpha < 0)
        return Alpha::none;
    return part.metadata.number("oiio:UnassociatedAlpha") != 0.0 ? Alpha::unassociated
                                                                 : Alpha::associated;
}

} // namespace

std::string color_space(const Given& given, const ImagePart& part)
{
    std::string stated = part.metadata.text("oiio:ColorSpace");
    // "Linear" too, which only OpenImageIO 2 states by itself.
    if (!stated.empty() && given.facts.openimageio_version >= 30000)
        return stated;
    return space_of_file(stated, part.metadata.text("colorInteropID"));
}

void decide_encoding(const Given& given, const ImagePart& part, Export& result)
{
    const bool is_raw = result.run.camera_input;
    const StatedEncoding said = stated_encoding(given, part, is_raw);
    const bool is_stated = !said.space.empty();
    const EncodingWords words { given.option("linearize", "srgb"),
                                given.dialect.is_linear,
                                [&] { return to_rec709(given.dialect, is_stated); } };
    result.curve = curve_of(said, given.options.undo, words);
    if (!is_raw)
        require_rec709_primaries(given, part, said.space);
    result.decoder
        = { result.curve, alpha(part, result.layer), levels_of(said.samples) };
}

} // namespace cg2raw

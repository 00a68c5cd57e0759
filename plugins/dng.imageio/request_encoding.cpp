// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "request_encoding.h"

#include "cg2raw/color.h"
#include "cg2raw/illuminant.h"
#include "cg2raw/types.h"

#include <OpenImageIO/color.h>
#include <OpenImageIO/strutil.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <iterator>

namespace cg2raw {
namespace {

using OIIO::ImageSpec;
using OIIO::Strutil::iequals;

/// What the words "linear" and "scene_linear" stand for is the OCIO config's business;
/// without one they are Rec.709.
bool is_rec709_word([[maybe_unused]] const std::string& word)
{
#if OIIO_VERSION < 30000
    if (!std::getenv("OCIO"))
        return true;
#endif
    const OIIO::ColorConfig config;
#if OIIO_VERSION >= 30000
    if (iequals(word, "linear"))
        return is_rec709_name(std::string(config.resolve(word)));
#endif
    const char* const role = config.getColorSpaceNameByRole("scene_linear");
    return !role || is_rec709_name(role);
}

bool is_rec709(const std::string& space)
{
    if (iequals(space, "linear") || iequals(space, "scene_linear"))
        return is_rec709_word(space);
    return space.empty() || is_rec709_name(space);
}

/// A space of the current config that is Rec.709, for the remedy of a message.
std::string rec709_of_config()
{
    const OIIO::ColorConfig config;
    for (int i = 0; i < config.getNumColorSpaces(); ++i)
        if (is_rec709_name(config.getColorSpaceNameByIndex(i)))
            return config.getColorSpaceNameByIndex(i);
    return std::getenv("OCIO") ? "<the config's linear Rec.709 space>" : "linear";
}

/// OpenEXR files may say their primaries themselves.
void require_rec709_primaries(const ImageSpec& spec)
{
    float said[8];
    if (!spec.getattribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8),
                           said))
        return;
    std::array<double, 8> chromaticities;
    std::copy(std::begin(said), std::end(said), chromaticities.begin());
    cg2raw::require_rec709_primaries(chromaticities, color_space_of(spec), OIIO_VERSION,
                                     rec709_of_config());
}

StatedEncoding encoding_of(const ImageSpec& spec, bool is_raw)
{
    const auto text = [&](const char* name) {
        return std::string(spec.get_string_attribute(name));
    };
    StatedEncoding said;
    said.space = color_space_of(spec);
    said.is_rec709 = is_rec709(said.space);
    said.is_raw = is_raw;
    said.samples = samples_of(spec);
    said.icc_profile = text("ICCProfile:profile_description");
    said.transfer = text("dpx:Transfer");
    return said;
}

/// "oiio:UnassociatedAlpha" is what readers state of pixels that are as in the file;
/// by default they multiply colour by alpha.
Alpha alpha_of(const ImageSpec& spec, const SceneLayer& layer)
{
    if (layer.alpha < 0)
        return Alpha::none;
    return spec.get_int_attribute("oiio:UnassociatedAlpha", 0) != 0
        ? Alpha::unassociated
        : Alpha::associated;
}

} // namespace

std::string color_space_of(const ImageSpec& spec)
{
    return space_of_file(std::string(spec.get_string_attribute("oiio:ColorSpace")),
                         std::string(spec.get_string_attribute("colorInteropID")));
}

std::string samples_of(const ImageSpec& spec)
{
    const bool is_exr = spec.find_attribute("screenWindowWidth") != nullptr;
    return is_exr ? "float" : std::string(spec.format.c_str());
}

Decoder decoder_of(const ImageSpec& spec, const Attributes& attributes,
                   const SceneLayer& layer, bool is_raw)
{
    const StatedEncoding said = encoding_of(spec, is_raw);
    // A host takes what states no space for linear light.
    const std::string from = said.space.empty() ? "--iscolorspace NAME " : "";
    const EncodingWords words { "--attrib dng:linearize srgb",
                                "--iscolorspace lin_rec709", [&] {
                                    return from + "--tocolorspace \""
                                        + rec709_of_config()
                                        + "\" (or \"RAW - <sensor> - <illuminant>\") "
                                          "before -o";
                                } };
    const Curve curve
        = curve_of(said, attributes.linearize ? Undo::srgb : Undo::none, words);
    if (!is_raw)
        require_rec709_primaries(spec);
    return { curve, alpha_of(spec, layer), levels_of(said.samples) };
}

} // namespace cg2raw

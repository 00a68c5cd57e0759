// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "request_spectrum.h"

#include <OpenImageIO/strutil.h>

namespace cg2raw {
namespace {

using OIIO::ImageSpec;
using OIIO::Strutil::iequals;
using OIIO::Strutil::istarts_with;

constexpr const char* estimate = "estimate";
constexpr const char* by_statistic = "estimate:";

bool is_estimate(const std::string& word)
{
    return iequals(word, estimate) || istarts_with(word, by_statistic);
}

/// A text that an OpenEXR file states.
std::optional<std::string> text_of(const ImageSpec& spec, const std::string& name)
{
    const OIIO::ParamValue* const said
        = spec.find_attribute(name, OIIO::TypeDesc::STRING);
    return said ? std::optional(std::string(said->get_string())) : std::nullopt;
}

/// The luminance that is white, as it is asked for or as OpenEXR files say it.
double white_of(const ImageSpec& spec, const Attributes& attributes)
{
    const double said = spec.get_float_attribute(
        "whiteLuminance", spec.get_float_attribute("openexr:whiteLuminance", 0));
    if (!attributes.exposure && said == 0.0)
        throw Error("which luminance is white? Its channels are spectral radiance in "
                    "W/(m2 sr nm): add --attrib dng:exposure CD_PER_M2, such as 100");
    return attributes.exposure.value_or(said);
}

/// What belongs to RGB alone.
void refuse_rgb_options(const Attributes& attributes)
{
    const std::string start = "its channels are a spectrum, so that ";
    if (attributes.convention && *attributes.convention != Convention::sensor
        && *attributes.convention != Convention::spectral)
        throw Error(
            start + "dng:convention " + name_of(*attributes.convention)
            + " has no meaning: leave it out, or name the picture by dng:layer");
    if (attributes.highlights.value_or(false))
        throw Error(start + "dng:highlights has no meaning: leave it out");
    if (attributes.linearize)
        throw Error(start + "dng:linearize has no meaning: leave it out");
    if (attributes.gain || attributes.sample_gain)
        throw Error(start + "dng:gain has no meaning: change dng:exposure");
}

/// The light's spectrum that the file states in its attribute "illuminant".
Spectrum stated_light(const ImageSpec& spec, const std::string& word)
{
    if (istarts_with(word, by_statistic))
        throw Error("dng:illuminant " + word
                    + " needs the whole image before its first row, which a host does "
                      "not give: use cg2raw convert, or name the light");
    for (const char* name : { "illuminant", "openexr:illuminant" }) {
        const auto text = text_of(spec, name);
        if (!text)
            continue;
        try {
            return spectrum_from_text(*text);
        } catch (const Error& error) {
            throw Error("attribute illuminant, the light's spectrum: "
                        + std::string(error.what()));
        }
    }
    throw Error(
        "dng:illuminant estimate: the image states no light's spectrum (--attrib "
        "illuminant \"400nm:0.3;410nm:0.5;...\"); add it, or name the light");
}

} // namespace

std::optional<SpectralChannels> bins_of(const ImageSpec& spec,
                                        const Attributes& attributes)
{
    if (!attributes.layer.empty())
        return std::nullopt;
    const auto wavelength = [&](const std::string& channel) -> std::optional<double> {
        const double metres = spec.get_float_attribute(channel + ".wavelength", 0);
        return metres == 0.0 ? std::nullopt : std::optional(metres);
    };
    const auto response
        = [&](const std::string& channel) { return text_of(spec, channel); };
    return spectral_channels(spec.channelnames, wavelength, response);
}

void put_spectrum(const ImageSpec& spec, const Attributes& attributes,
                  const SpectralChannels& bins, Request& request)
{
    refuse_rgb_options(attributes);
    const SensorProfile& profile = request.profile;
    if (!profile.spectral_sensitivities)
        throw Error("its channels are a spectrum, and sensor " + profile.id
                    + " has no spectral_sensitivities: make a profile with cg2raw "
                      "profile --ssf, or take the RGB picture (oiiotool --ch R,G,B)");
    Run& run = request.run;
    const double white = white_of(spec, attributes);
    if (is_estimate(run.illuminant)) {
        const Spectrum light = stated_light(spec, run.illuminant);
        request.spectral.emplace(profile, light, bins, white);
        run.illuminant = neutral_word(profile, light);
    } else {
        const Illuminant light = illuminant(profile, run.illuminant, run.as_shot);
        request.spectral.emplace(profile, spectrum_of(profile, light).power, bins,
                                 white);
        run.illuminant = seen_by_sensitivities(profile, run.illuminant);
    }
    run.camera_input = true;
    run.convention = Convention::sensor;
}

void refuse_estimate(const std::string& illuminant)
{
    if (is_estimate(illuminant))
        throw Error("dng:illuminant " + illuminant
                    + " is for spectral images, and this one has no channels such as "
                      "S0.550nm: name the light");
}

} // namespace cg2raw

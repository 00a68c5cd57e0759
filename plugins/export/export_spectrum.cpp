// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What decides an export of an image whose channels are a spectrum.
#include "rules.h"

#include "cg2raw/exposure.h"
#include "core/text.h"

#include <algorithm>

namespace cg2raw {
namespace {

constexpr std::string_view estimate = "estimate";
constexpr std::string_view by_statistic = "estimate:";

bool starts_with(std::string_view text, std::string_view start)
{
    return lower_case(text.substr(0, start.size())) == start;
}

bool is_estimate(std::string_view word)
{
    return lower_case(word) == estimate || starts_with(word, by_statistic);
}

/// A text that a file states; not of its numbers.
std::optional<std::string> stated_text(const Metadata& metadata,
                                       const std::string& name)
{
    const Metadata::Value* const value = metadata.find(name);
    const auto* const text = value ? std::get_if<std::string>(value) : nullptr;
    return text ? std::optional(*text) : std::nullopt;
}

/// Whether time, aperture and ISO are known, or all but the one that a meter finds.
bool has_settings(const Run& run)
{
    const int known = run.exposure_time.has_value() + run.f_number.has_value()
        + run.iso.has_value();
    return known == 3 || (known == 2 && needs_meter(run));
}

/// The luminance that is white, as an option or OpenEXR files say it. Settings of a
/// camera say it too: any will do then, and the signal follows them.
double white_luminance(const Given& given, const Metadata& metadata, Run& run)
{
    if (given.options.white_luminance)
        return *given.options.white_luminance;
    if (const auto stated = stated_white(metadata))
        return *stated;
    if (has_settings(run)) {
        run.scene_luminance = 100.0;
        return *run.scene_luminance;
    }
    throw Error("its channels are a spectrum in W/(m2 sr nm): which luminance is "
                "white? Add "
                + given.option("white_luminance", "CD_PER_M2") + ", such as 100, or "
                + given.option("exposure_time") + ", " + given.option("f_number")
                + " and " + given.option("iso"));
}

/// What belongs to RGB alone.
void refuse_rgb_options(const Given& given)
{
    const ExportOptions& options = given.options;
    const auto refuse = [&](const char* name, const std::string& remedy) {
        throw Error("its channels are a spectrum, so that " + given.option(name)
                    + " has no meaning: " + remedy);
    };
    if (options.convention && *options.convention != Convention::sensor
        && *options.convention != Convention::spectral)
        throw Error("its channels are a spectrum, so that "
                    + given.option("convention", name_of(*options.convention))
                    + " has no meaning: leave it out, or name the picture by "
                    + given.option("layer"));
    if (options.highlights.value_or(false))
        refuse("highlights", "leave it out");
    if (options.undo == Undo::srgb)
        refuse("linearize", "leave it out");
    if (options.digital_gain || options.sample_digital_gain)
        refuse("digital_gain", "change " + given.option("exposure"));
    if (options.scene_luminance)
        refuse("scene_luminance", "its luminance is known; leave it out");
}

[[noreturn]] void fail_without_light(const Given& given)
{
    const std::string typed = given.dialect.converts ? "--attrib" : "attribute";
    throw Error(given.option("illuminant") + " " + std::string(estimate)
                + ": the image states no light's spectrum (" + typed
                + " illuminant \"400nm:0.3;410nm:0.5;...\"); add it, or name the light"
                + (given.facts.measured_light
                       ? ", or estimate:mean (grey world), estimate:max (brightest)"
                       : ""));
}

/// The light that the image itself says.
Spectrum estimated_light(const Given& given, const Metadata& metadata,
                         const SpectralChannels& bins, const std::string& word)
{
    if (!starts_with(word, by_statistic)) {
        if (auto light = stated_light(metadata))
            return *light;
        fail_without_light(given);
    }
    if (!given.facts.measured_light)
        throw Error(given.option("illuminant") + " " + word
                    + " needs the whole image before its first row, which a host does "
                      "not give: use cg2raw convert, or name the light");
    return given.facts.measured_light(word, bins);
}

bool are_unnamed(const std::vector<std::string>& channels)
{
    return std::all_of(channels.begin(), channels.end(),
                       [](const std::string& name) { return name.empty(); });
}

} // namespace

std::optional<SpectralChannels> spectral_bins(const ImagePart& part)
{
    const auto wavelength = [&](const std::string& channel) -> std::optional<double> {
        const double metres = part.metadata.number(channel + ".wavelength");
        return metres == 0.0 ? std::nullopt : std::optional(metres);
    };
    const auto response = [&](const std::string& channel) {
        return stated_text(part.metadata, channel);
    };
    auto bins = spectral_channels(part.names.channels, wavelength, response);
    if (bins)
        require_flat(part);
    return bins;
}

std::optional<Spectrum> stated_light(const Metadata& metadata)
{
    for (const char* name : { "illuminant", "openexr:illuminant" }) {
        const auto text = stated_text(metadata, name);
        if (!text)
            continue;
        try {
            return spectrum_from_text(*text);
        } catch (const Error& error) {
            throw Error("attribute illuminant, the light's spectrum: "
                        + std::string(error.what()));
        }
    }
    return std::nullopt;
}

std::optional<double> stated_white(const Metadata& metadata)
{
    for (const char* name : { "whiteLuminance", "openexr:whiteLuminance" })
        if (const double stated = metadata.number(name); stated != 0.0)
            return stated;
    return std::nullopt;
}

void decide_spectrum(const Given& given, const ImagePart& part, Export& result)
{
    refuse_rgb_options(given);
    const SensorProfile& profile = result.profile;
    if (!profile.spectral_sensitivities)
        throw Error("its channels are a spectrum, and sensor " + profile.id
                    + " has no spectral_sensitivities: make a profile with cg2raw "
                      "profile --ssf, or take the RGB picture (oiiotool --ch R,G,B)");
    Run& run = result.run;
    const double white = white_luminance(given, part.metadata, run);
    if (is_estimate(run.illuminant)) {
        const Spectrum light
            = estimated_light(given, part.metadata, *result.bins, run.illuminant);
        result.spectral.emplace(profile, light, *result.bins, white);
        run.illuminant = neutral_word(profile, light);
    } else {
        const Illuminant light = illuminant(profile, run.illuminant, run.as_shot);
        result.spectral.emplace(profile, spectrum_of(profile, light).power,
                                *result.bins, white);
        run.illuminant = seen_by_sensitivities(profile, run.illuminant);
    }
    run.camera_input = true;
    run.convention = Convention::sensor;
}

void refuse_spectral_options(const Given& given, const std::string& illuminant)
{
    constexpr const char* no_spectrum = "and this one has no channels such as S0.550nm";
    if (given.options.white_luminance)
        throw Error(
            given.option("white_luminance")
            + " is the luminance of white of a spectral image, "
            + (are_unnamed(given.facts.parts.front().names.channels)
                   ? "and the channels of this one have no names, as those of "
                     "--missingfile black: add --chnames S0.550nm,... as the other "
                     "frames have them, or leave it out"
                   : no_spectrum + std::string(": leave it out")));
    if (is_estimate(illuminant))
        throw Error(given.option("illuminant") + " " + illuminant
                    + " is for spectral images, " + no_spectrum + ": name the light");
}

} // namespace cg2raw

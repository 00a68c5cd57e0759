// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "request.h"

#include "attributes.h"
#include "cg2raw/dng_reader.h"
#include "request_shot.h"
#include "request_spectrum.h"

#include <OpenImageIO/color.h>
#include <OpenImageIO/strutil.h>

#include <algorithm>
#include <array>
#include <cmath>
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

std::string color_space_of(const ImageSpec& spec)
{
    return spec.get_string_attribute("oiio:ColorSpace");
}

void require_rec709(const std::string& space)
{
    if (!is_rec709(space))
        throw Error("colour space \"" + space
                    + "\" is neither scene-linear Rec.709 nor a RAW space: add "
                      "--tocolorspace \""
                    + rec709_of_config()
                    + "\" (or \"RAW - <sensor> - <illuminant>\") before -o");
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

/// A name is of a channel that the host's pixels have.
void require_channels(const ImageSpec& spec)
{
    if (spec.channelnames.size() > std::size_t(std::max(spec.nchannels, 0)))
        throw Error("its pixels have " + std::to_string(spec.nchannels)
                    + " channels, and it names "
                    + std::to_string(spec.channelnames.size())
                    + ": give a name to each");
}

/// The channels to take. Hosts hand over one image of a file that may have several.
SceneLayer layer_of(const ImageSpec& spec, const std::string& asked)
{
    LayerHints hints { "--attrib dng:layer" };
    hints.other_parts = spec.get_int_attribute("oiio:subimages", 1) > 1;
    const ScenePart part { std::string(spec.get_string_attribute("oiio:subimagename")),
                           spec.channelnames };
    return beauty_layer({ part }, asked, hints);
}

/// The name that a file will have: oiiotool writes <stem>.<8 hex digits>.temp.<ending>
/// and renames that.
std::string final_name(const std::string& file)
{
    constexpr std::size_t digits = 8;
    const auto temp = file.rfind(".temp.");
    if (temp == file.npos || temp <= digits || file[temp - digits - 1] != '.'
        || file.substr(temp - digits, digits).find_first_not_of("0123456789abcdef")
            != file.npos)
        return file;
    return file.substr(0, temp - digits - 1) + file.substr(temp + 5);
}

std::uint64_t frame_of(const ImageSpec& spec, const Attributes& attributes,
                       const std::string& file)
{
    if (attributes.frame)
        return *attributes.frame;
    if (const auto frame = frame_from_name(final_name(file)))
        return *frame;
    // Not get_string_attribute(), which is empty for time codes in OpenImageIO 2.4.
    const OIIO::ParamValue* const code = spec.find_attribute("smpte:TimeCode");
    return code ? frame_from_time_code(std::string(code->get_string())).value_or(0) : 0;
}

/// The space of the pixels, if they already are RAW; contradictions are errors.
std::optional<RawSpace> raw_space_of(const ImageSpec& spec,
                                     const Attributes& attributes,
                                     const std::optional<SensorProfile>& sensor)
{
    auto sensors = installed_profiles();
    if (sensor)
        sensors.push_back(sensor->id);
    const std::string name = color_space_of(spec);
    auto space = raw_space_from_name(name, sensors);
    if (!space)
        return std::nullopt;
    const std::string pixels = "pixels already are \"" + name + "\"";
    if (sensor && !iequals(sensor->id, space->sensor))
        throw Error(pixels + ", but dng:sensor is " + sensor->id
                    + ": leave dng:sensor out, or convert to its RAW space");
    if (!attributes.illuminant.empty()
        && !iequals(attributes.illuminant, space->illuminant))
        throw Error(pixels + ", but dng:illuminant is " + attributes.illuminant
                    + ": leave dng:illuminant out, or convert to its RAW space");
    if (attributes.convention || attributes.gain || attributes.sample_gain
        || attributes.highlights)
        throw Error(pixels
                    + ": dng:convention, dng:gain and dng:highlights belong to the "
                      "conversion, which has been done; leave them out");
    return space;
}

void check_bits(const ImageSpec& spec, const SensorProfile& profile)
{
    const int bits = spec.get_int_attribute("oiio:BitsPerSample", 0);
    if (bits > 8 && bits < 16 && bits != profile.bits)
        throw Error("a sensor of " + std::to_string(profile.bits) + " bits ("
                    + profile.id + ") cannot write " + std::to_string(bits)
                    + " bits: leave -d and bits out, or say uint16");
}

Run run_of(const Attributes& attributes)
{
    if (attributes.noise && !attributes.iso)
        throw Error("dng:noise is given without dng:iso: add --attrib dng:iso NUMBER, "
                    "or leave dng:noise out");
    Run run;
    run.illuminant = attributes.illuminant;
    run.iso = attributes.iso;
    run.noise_model = attributes.noise;
    run.seed = attributes.seed;
    run.digital_gain = attributes.gain.value_or(1.0);
    run.sample_digital_gain = attributes.sample_gain;
    run.convention = attributes.convention.value_or(Convention::dng);
    run.keep_highlights = attributes.highlights.value_or(true);
    run.effects = attributes.effects;
    return run;
}

/// What pixels that are no RAW must have beside them: a sensor and Rec.709.
void require_scene(const ImageSpec& spec, const Attributes& attributes, bool has_sensor,
                   bool is_spectral)
{
    if (!has_sensor && attributes.reference.empty())
        throw Error("which sensor? Add --attrib dng:sensor ID (cg2raw doctor lists "
                    "them) or --attrib dng:reference FILE.dng, or convert with "
                    "--tocolorspace \"RAW - <sensor> - <illuminant>\"");
    if (is_spectral)
        return;
    require_rec709(color_space_of(spec));
    require_rec709_primaries(spec);
}

/// A light, or a sensor that needs none; a RAW space, or a sensor that has one.
void require_light(const Request& request)
{
    const bool mono = request.profile.cfa.is_mono();
    if (!mono && request.run.illuminant.empty())
        throw Error("under which light? Add --attrib dng:illuminant WORD: "
                    + std::string(illuminant_grammar));
    if (mono && request.run.camera_input)
        throw Error(
            "sensor " + request.profile.id
            + " is monochrome and has no RAW colour space: leave the conversion "
              "to it out and name the sensor by dng:sensor");
}

/// The profile, neutral and shot of the DNG @p file; of @p sensor, if there is one,
/// what a DNG does not say.
void put_reference(const std::string& file, const std::optional<SensorProfile>& sensor,
                   Request& request)
{
    const DngMetadata metadata = read_dng_metadata(file);
    const SensorProfile reference = profile_from_dng(metadata);
    request.profile = sensor ? with_measurements(reference, *sensor, file) : reference;
    request.run.as_shot = metadata.as_shot_neutral;
    request.shot = merged(metadata.shot, request.shot);
}

} // namespace

Request request_of(const ImageSpec& spec, const std::string& file)
{
    const Attributes attributes = attributes_of(spec);
    require_channels(spec);
    const auto bins = bins_of(spec, attributes);
    if (!bins && attributes.exposure)
        throw Error("dng:exposure is the luminance of white of a spectral image, and "
                    "this one has no channels such as S0.550nm: leave it out");
    const SceneLayer layer = bins ? SceneLayer {} : layer_of(spec, attributes.layer);
    std::optional<SensorProfile> sensor;
    if (!attributes.sensor.empty())
        sensor = load_profile(attributes.sensor);
    Request request { layer, {}, {}, run_of(attributes), attributes.options, {} };
    request.run.frame = frame_of(spec, attributes, file);
    request.shot = shot_of(spec, attributes, request.run.frame);

    if (const auto space
        = bins ? std::nullopt : raw_space_of(spec, attributes, sensor)) {
        request.run.camera_input = true;
        request.run.color_effects = false;
        request.run.illuminant = space->illuminant;
        if (!sensor)
            sensor = load_profile(space->sensor);
    } else {
        require_scene(spec, attributes, sensor.has_value(), bins.has_value());
    }
    if (!bins)
        refuse_estimate(request.run.illuminant);
    if (attributes.reference.empty())
        request.profile = *sensor;
    else
        put_reference(attributes.reference, sensor, request);
    require_light(request);
    if (bins)
        put_spectrum(spec, attributes, *bins, request);
    request.run.exposure_time = request.shot.exposure_time;
    if (attributes.iso)
        request.shot.iso = int(std::lround(*attributes.iso));
    check_bits(spec, request.profile);
    return request;
}

} // namespace cg2raw

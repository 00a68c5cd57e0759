// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "request.h"

#include "attributes.h"
#include "cg2raw/dng_reader.h"
#include "request_encoding.h"
#include "request_shot.h"
#include "request_spectrum.h"

#include <OpenImageIO/strutil.h>

#include <algorithm>
#include <cmath>

namespace cg2raw {
namespace {

using OIIO::ImageSpec;
using OIIO::Strutil::iequals;

/// A name is of a channel that the host's pixels have.
void require_channels(const ImageSpec& spec)
{
    if (spec.channelnames.size() > std::size_t(std::max(spec.nchannels, 0)))
        throw Error("its pixels have " + std::to_string(spec.nchannels)
                    + " channels, and it names "
                    + std::to_string(spec.channelnames.size())
                    + ": give a name to each");
}

/// Reads what DNGs are read as: their mosaic, or one pixel of those that cannot be.
void refuse_raw(const ImageSpec& spec)
{
    const std::string unreadable(spec.get_string_attribute("raw:Unreadable"));
    const bool is_mosaic = spec.nchannels == 1
        && !spec.get_string_attribute("raw:FilterPattern").empty();
    if (is_mosaic || !unreadable.empty())
        throw Error(
            raw_already
            + (unreadable.empty() ? "" : "; and cannot be read: " + unreadable));
}

/// The channels to take. Hosts hand over one image of a file that may have several.
SceneLayer layer_of(const ImageSpec& spec, const std::string& asked)
{
    const bool other_parts = spec.get_int_attribute("oiio:subimages", 1) > 1;
    LayerHints hints { "--attrib dng:layer", other_parts, {} };
    for (const OIIO::ParamValue& said : spec.extra_attribs)
        if (OIIO::Strutil::istarts_with(said.name(), "cryptomatte/")
            && OIIO::Strutil::iends_with(said.name(), "/name"))
            hints.data.emplace_back(said.get_string());
    ScenePart part { std::string(spec.get_string_attribute("oiio:subimagename")),
                     spec.channelnames };
    part.channels.resize(std::size_t(std::max(spec.nchannels, 0)));
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

std::int64_t frame_of(const ImageSpec& spec, const Attributes& attributes,
                      const std::string& file)
{
    if (attributes.frame)
        return *attributes.frame;
    if (const auto name = frame_name(final_name(file)))
        return name->number;
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

/// Floats have as many bits as "-d" asks for; whole numbers those of their file, of
/// which a DPX has 10 or 12.
void check_bits(const ImageSpec& spec, const SensorProfile& profile)
{
    if (levels_of(samples_of(spec)) != 0)
        return;
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

/// Pixels that are no RAW need a sensor.
void require_sensor(const Attributes& attributes)
{
    if (attributes.sensor.empty() && attributes.reference.empty())
        throw Error("which sensor? Add --attrib dng:sensor ID (cg2raw doctor lists "
                    "them) or --attrib dng:reference FILE.dng, or convert with "
                    "--tocolorspace \"RAW - <sensor> - <illuminant>\"; if its pixels "
                    "are RAW already, --iscolorspace \"RAW - <sensor> - <illuminant>\" "
                    "in place of them");
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
    refuse_raw(spec);
    const auto bins = bins_of(spec, attributes);
    if (!bins && attributes.exposure)
        throw Error("dng:exposure is the luminance of white of a spectral image, and "
                    "this one has no channels such as S0.550nm: leave it out");
    const SceneLayer layer = bins ? SceneLayer {} : layer_of(spec, attributes.layer);
    std::optional<SensorProfile> sensor;
    if (!attributes.sensor.empty())
        sensor = load_profile(attributes.sensor);
    Request request { layer, {}, {}, {}, run_of(attributes), attributes.options, {} };
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
        require_sensor(attributes);
    }
    if (!bins)
        request.decoder = decoder_of(spec, attributes, layer, request.run.camera_input);
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

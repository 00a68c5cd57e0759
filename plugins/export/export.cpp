// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The order in which an export is decided, and the rules that fit in a few
/// lines.
#include "cg2raw/export.h"

#include "cg2raw/dng_reader.h"
#include "cg2raw/exposure.h"
#include "core/text.h"
#include "rules.h"

#include <algorithm>

namespace cg2raw {
namespace {

/// Reads what DNGs are read as: their mosaic, or one pixel of those that cannot be.
void refuse_raw(const ImagePart& part)
{
    const std::string unreadable = part.metadata.text("raw:Unreadable");
    const bool is_mosaic = part.names.channels.size() == 1
        && !part.metadata.text("raw:FilterPattern").empty();
    if (is_mosaic || !unreadable.empty())
        throw Error(
            raw_already
            + (unreadable.empty() ? "" : "; and cannot be read: " + unreadable));
}

/// Layers that Cryptomatte says are its own.
std::vector<std::string> cryptomatte_layers(const Metadata& metadata)
{
    std::vector<std::string> names;
    constexpr std::string_view start = "cryptomatte/", end = "/name";
    for (const auto& [name, value] : metadata.values())
        if (name.size() > start.size() + end.size()
            && name.compare(0, start.size(), start) == 0
            && name.compare(name.size() - end.size(), end.size(), end) == 0)
            names.push_back(metadata.text(name));
    return names;
}

std::int64_t frame_number(const Given& given, const ImagePart& part)
{
    if (given.options.frame)
        return *given.options.frame;
    if (const auto name = frame_name(given.facts.output_name))
        return name->number;
    if (const auto number = time_code_frame(part.metadata))
        return *number;
    const auto name = frame_name(given.facts.input_name);
    return name ? name->number : 0;
}

/// The option, else what a file says as it does for all formats: "none" of oiiotool's
/// --compression, or of an input that was not compressed, and "ljpeg-2d". Other words
/// name codecs of other formats, as a rule the input's; the mosaic is compressed then.
Compression compression(const Given& given, const ImagePart& part)
{
    if (given.options.compression)
        return *given.options.compression;
    const std::string said = lower_case(part.metadata.text("compression"));
    if (said == "none")
        return Compression::none;
    return said == "ljpeg-2d" ? Compression::ljpeg_2d : Compression::ljpeg;
}

/// What the options say of one exposure.
Run exposure(const Given& given)
{
    const ExportOptions& options = given.options;
    if (options.noise && !options.iso)
        throw Error(given.option("noise") + " is given without " + given.option("iso")
                    + ": add " + given.option("iso", "NUMBER") + ", or leave "
                    + given.option("noise") + " out");
    Run run;
    run.illuminant = options.illuminant;
    run.iso = options.iso;
    run.noise_model = options.noise;
    run.seed = options.seed;
    run.digital_gain = options.digital_gain.value_or(1.0);
    run.sample_digital_gain = options.sample_digital_gain;
    run.exposure = options.exposure;
    run.scene_luminance = options.scene_luminance;
    run.nd_filter = options.nd_filter.value_or(0.0);
    run.time_limits = options.time_limits;
    run.f_number_limits = options.f_number_limits;
    run.iso_limits = options.iso_limits;
    run.bracket = options.bracket;
    run.convention = options.convention.value_or(Convention::dng);
    run.keep_highlights = options.highlights.value_or(true);
    run.effects = options.effects;
    return run;
}

void require_picture(const ImageFacts& facts)
{
    if (facts.parts.size() == 1)
        require_flat(facts.parts[0]);
    refuse_raw(facts.parts[0]);
}

const ImagePart& part_of(const ImageFacts& facts, const Export& result)
{
    return facts.parts[std::size_t(result.layer.part)];
}

/// All that needs no camera, but for the curve, of an image whose layer is decided.
void decide_frame(const Given& given, Export& result)
{
    const ImagePart& part = part_of(given.facts, result);
    result.run = exposure(given);
    result.run.frame = frame_number(given, part);
    result.shot = shot(given, part, result.run.frame);
    result.file = given.options.file;
    result.file.compression = compression(given, part);
}

/// What is done before pixels are RAW, and an option of it.
std::string conversion_option(const Given& given)
{
    const ExportOptions& options = given.options;
    if (options.convention)
        return given.option("convention");
    if (options.digital_gain || options.sample_digital_gain)
        return given.option("digital_gain");
    if (options.exposure)
        return given.option("exposure");
    if (options.scene_luminance)
        return given.option("scene_luminance");
    return options.highlights ? given.option("highlights") : "";
}

/// The space of the pixels, if they already are RAW; contradictions are errors.
std::optional<RawSpace> raw_space(const Given& given, const ImagePart& part,
                                  const std::optional<SensorProfile>& sensor)
{
    auto sensors = installed_profiles();
    if (sensor)
        sensors.push_back(sensor->id);
    const std::string name = color_space(given, part);
    auto space = raw_space_from_name(name, sensors);
    if (!space)
        return std::nullopt;
    const std::string pixels = "pixels already are \"" + name + "\"";
    const auto refuse_other = [&](const char* option, const std::string& value) {
        throw Error(pixels + ", but " + given.option(option) + " is " + value
                    + ": leave " + given.option(option)
                    + " out, or convert to its RAW space");
    };
    if (sensor && lower_case(sensor->id) != lower_case(space->sensor))
        refuse_other("sensor", sensor->id);
    const std::string& light = given.options.illuminant;
    if (!light.empty() && lower_case(light) != lower_case(space->illuminant))
        refuse_other("illuminant", light);
    if (const std::string option = conversion_option(given); !option.empty())
        throw Error(pixels + ": " + option
                    + " belongs to the conversion, which has been done; leave it out");
    return space;
}

/// Pixels that are no RAW need a sensor.
void require_sensor(const Given& given)
{
    const ExportOptions& options = given.options;
    if (!options.sensor.empty() || !options.reference.empty())
        return;
    const std::string raw = "\"RAW - <sensor> - <illuminant>\"";
    throw Error("which sensor? If its pixels are RAW already, add --iscolorspace " + raw
                + ", else " + given.option("sensor", "ID")
                + " (cg2raw sensors lists them)"
                + (given.dialect.converts ? ", " : " or ")
                + given.option("reference", "FILE.dng")
                + (given.dialect.converts ? " or --tocolorspace " + raw : ""));
}

/// A light, or a sensor that needs none; a RAW space, or a sensor that has one.
void require_light(const Given& given, const Export& result)
{
    const bool mono = result.profile.cfa.is_mono();
    if (!mono && result.run.illuminant.empty())
        throw Error("under which light? Add " + given.option("illuminant", "WORD")
                    + ": " + illuminant_grammar);
    if (mono && result.run.camera_input)
        throw Error(
            "sensor " + result.profile.id
            + " is monochrome and has no RAW colour space: leave the conversion "
              "to it out and name the sensor by "
            + given.option("sensor"));
}

/// The profile, neutral and shot of the DNG @p file; of @p sensor, if there is one,
/// what a DNG does not say.
void apply_reference(const std::string& file,
                     const std::optional<SensorProfile>& sensor, Export& result)
{
    const DngMetadata metadata = read_dng_metadata(file);
    const SensorProfile reference = profile_from_dng(metadata);
    result.profile = sensor ? with_measurements(reference, *sensor, file) : reference;
    result.run.as_shot = metadata.as_shot_neutral;
    result.shot = merged(metadata.shot, result.shot);
}

/// Time and aperture are the options', else those that are stated.
void decide_settings(const ExportOptions& options, Export& result)
{
    Run& run = result.run;
    run.exposure_time
        = options.exposure_time ? options.exposure_time : result.shot.exposure_time;
    run.f_number = options.f_number ? options.f_number : result.shot.f_number;
}

/// The exposure must make sense. What a meter finds is not known yet.
void check_exposure(const Given& given, const Export& result)
{
    Run read = result.run;
    read.meter = 1.0;
    settle(result.profile, read, given.dialect.option);
}

void check_bits(const Given& given, const SensorProfile& profile)
{
    const int bits = given.facts.output_bits;
    if (bits > 8 && bits < 16 && bits != profile.bits)
        throw Error("a sensor of " + std::to_string(profile.bits) + " bits ("
                    + profile.id + ") cannot write " + std::to_string(bits)
                    + " bits: leave -d and bits out, or say uint16");
}

} // namespace

void require_flat(const ImagePart& part)
{
    if (!part.is_flat)
        throw Error("deep and volume images cannot become a DNG: flatten first "
                    "(oiiotool --flatten)");
}

SceneLayer picture_layer(const ImageFacts& facts, const ExportOptions& options,
                         const Dialect& dialect)
{
    require_picture(facts);
    const std::vector<ImagePart>& parts = facts.parts;
    // Hosts hand over one image of a file that may have several.
    const double in_file = parts[0].metadata.number("oiio:subimages");
    LayerHints hints { [&](const std::string& name) {
                          return dialect.option("layer", name);
                      },
                       in_file > double(parts.size()),
                       {} };
    std::vector<ScenePart> names;
    for (const ImagePart& part : parts) {
        names.push_back(part.names);
        for (std::string& name : cryptomatte_layers(part.metadata))
            hints.data.push_back(std::move(name));
    }
    const SceneLayer layer = beauty_layer(names, options.layer, hints);
    require_flat(parts[std::size_t(layer.part)]);
    return layer;
}

Export resolve_picture(const ImageFacts& facts, const ExportOptions& options,
                       const Dialect& dialect)
{
    const Given given { facts, options, dialect };
    Export result;
    result.layer = picture_layer(facts, options, dialect);
    decide_frame(given, result);
    decide_encoding(given, part_of(facts, result), result);
    decide_settings(options, result);
    check_exposure(given, result);
    return result;
}

Export resolve(const ImageFacts& facts, const ExportOptions& options,
               const Dialect& dialect)
{
    const Given given { facts, options, dialect };
    require_picture(facts);
    Export result;
    if (options.layer.empty()) // a layer that is named is a picture
        result.bins = spectral_bins(facts.parts[0]);
    if (!result.bins) {
        refuse_spectral_options(given, options.illuminant);
        result.layer = picture_layer(facts, options, dialect);
    }
    decide_frame(given, result);
    const ImagePart& part = part_of(facts, result);
    std::optional<SensorProfile> sensor;
    if (!options.sensor.empty())
        sensor = load_profile(options.sensor);
    if (const auto space
        = result.bins ? std::nullopt : raw_space(given, part, sensor)) {
        result.run.camera_input = true;
        result.run.color_effects = false;
        result.run.illuminant = space->illuminant;
        if (!sensor)
            sensor = load_profile(space->sensor);
    } else {
        require_sensor(given);
    }
    if (!result.bins)
        decide_encoding(given, part, result);
    if (options.reference.empty())
        result.profile = *sensor;
    else
        apply_reference(options.reference, sensor, result);
    require_light(given, result);
    decide_settings(options, result);
    if (result.bins)
        decide_spectrum(given, part, result);
    check_exposure(given, result);
    check_bits(given, result.profile);
    return result;
}

} // namespace cg2raw

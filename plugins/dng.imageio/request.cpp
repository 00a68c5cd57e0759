// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "request.h"

#include "attributes.h"
#include "cg2raw/dng_reader.h"

#include <OpenImageIO/color.h>
#include <OpenImageIO/strutil.h>

#include <cmath>

namespace cg2raw {
namespace {

using OIIO::ImageSpec;
using OIIO::Strutil::iequals;

/// Names that OpenImageIO and common configs give to scene-linear Rec.709.
constexpr const char* rec709_names[] = { "",
                                         "linear",
                                         "lin_srgb",
                                         "lin_rec709",
                                         "srgb_linear",
                                         "lin_srgb_scene",
                                         "lin_rec709_scene",
                                         "linear rec.709 (srgb)",
                                         "linear rec.709",
                                         "lin_rec709_srgb",
                                         "utility - linear - rec.709",
                                         "utility - linear - srgb",
                                         "linear srgb" };

bool is_rec709(const std::string& space)
{
    for (const char* name : rec709_names)
        if (iequals(space, name))
            return true;
    if (!iequals(space, "scene_linear"))
        return false;
    // A role: which space it stands for is the config's business.
    const OIIO::ColorConfig config;
    const char* const resolved = config.getColorSpaceNameByRole("scene_linear");
    return !resolved || (!iequals(resolved, "scene_linear") && is_rec709(resolved));
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
                      "--tocolorspace linear (or \"RAW - <sensor> - <illuminant>\") "
                      "before -o");
}

/// The profile of a reference DNG, with what only a measured profile knows.
SensorProfile with_measurements(SensorProfile reference, const SensorProfile& measured,
                                const std::string& file)
{
    if (!iequals(reference.unique_camera_model, measured.unique_camera_model)
        && !iequals(reference.model, measured.model))
        throw Error("dng:reference " + file + " is of a \""
                    + reference.unique_camera_model + "\", dng:sensor " + measured.id
                    + " is a \"" + measured.unique_camera_model
                    + "\": give only one of them, or a pair "
                      "of the same camera");
    reference.id = measured.id;
    reference.illuminants = measured.illuminants;
    reference.digital_gain = measured.digital_gain;
    reference.effects = measured.effects;
    if (!measured.noise.empty())
        reference.noise = measured.noise;
    return reference;
}

/// A date as Exif writes it, "YYYY:MM:DD HH:MM:SS", or nothing.
std::string exif_date(const std::string& text)
{
    const std::string form = "0000:00:00 00:00:00";
    if (text.size() != form.size())
        return "";
    for (std::size_t i = 0; i < form.size(); ++i)
        if (form[i] == '0' ? text[i] < '0' || text[i] > '9' : text[i] != form[i])
            return "";
    return text;
}

/// Exif that renderers and oiiotool put into an image. What makes no sense there is
/// left out: it is no reason to refuse the picture.
Shot shot_of(const ImageSpec& spec)
{
    Shot shot;
    const auto positive = [&](const char* name) -> std::optional<double> {
        // OpenImageIO 2.4 makes no float of an int.
        const float value = spec.get_float_attribute(
            name, float(spec.get_int_attribute(name, 0)));
        return value >= 1e-6f && value <= 1e6f ? std::optional<double>(value)
                                               : std::nullopt;
    };
    shot.exposure_time = positive("ExposureTime");
    shot.f_number = positive("FNumber");
    shot.focal_length = positive("Exif:FocalLength");
    shot.date_time_original = exif_date(spec.get_string_attribute(
        "Exif:DateTimeOriginal", spec.get_string_attribute("DateTime")));
    shot.artist = spec.get_string_attribute("Artist");
    shot.copyright = spec.get_string_attribute("Copyright");
    shot.description = spec.get_string_attribute("ImageDescription");
    shot.lens_model = spec.get_string_attribute("Exif:LensModel");
    const int orientation = spec.get_int_attribute("Orientation", 1);
    shot.orientation = orientation >= 1 && orientation <= 8 ? orientation : 1;
    return shot;
}

/// Exif of the reference, and of the image what the reference lacks. Orientation,
/// author, rights and description are the image's own: they are not the camera's.
Shot merged(Shot reference, const Shot& image)
{
    reference.orientation = image.orientation;
    if (!reference.exposure_time)
        reference.exposure_time = image.exposure_time;
    if (!reference.f_number)
        reference.f_number = image.f_number;
    if (!reference.focal_length)
        reference.focal_length = image.focal_length;
    reference.artist = image.artist;
    reference.copyright = image.copyright;
    reference.description = image.description;
    for (auto text : { &Shot::date_time_original, &Shot::lens_model })
        if ((reference.*text).empty())
            reference.*text = image.*text;
    return reference;
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
    const auto space = raw_space_from_name(name, sensors);
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
    Run run;
    run.illuminant = attributes.illuminant;
    run.iso = attributes.iso;
    run.seed = attributes.seed;
    run.frame = attributes.frame;
    run.digital_gain = attributes.gain.value_or(1.0);
    run.sample_digital_gain = attributes.sample_gain;
    run.convention = attributes.convention.value_or(Convention::dng);
    run.keep_highlights = attributes.highlights.value_or(true);
    run.effects = attributes.effects;
    return run;
}

} // namespace

Request request_of(const ImageSpec& spec)
{
    const Attributes attributes = attributes_of(spec);
    std::optional<SensorProfile> sensor;
    if (!attributes.sensor.empty())
        sensor = load_profile(attributes.sensor);
    Request request { {}, run_of(attributes), attributes.options, shot_of(spec) };

    const auto space = raw_space_of(spec, attributes, sensor);
    if (space) {
        request.run.camera_input = true;
        request.run.illuminant = space->illuminant;
        if (!sensor)
            sensor = load_profile(space->sensor);
    } else {
        if (!sensor && attributes.reference.empty())
            throw Error("which sensor? Add --attrib dng:sensor ID (cg2raw doctor lists "
                        "them) or --attrib dng:reference FILE.dng, or convert with "
                        "--tocolorspace \"RAW - <sensor> - <illuminant>\"");
        require_rec709(color_space_of(spec));
        if (attributes.illuminant.empty())
            throw Error("under which light? Add --attrib dng:illuminant WORD: "
                        + std::string(illuminant_grammar));
    }
    if (!attributes.reference.empty()) {
        const DngMetadata metadata = read_dng_metadata(attributes.reference);
        const SensorProfile reference = profile_from_dng(metadata);
        request.profile = sensor
            ? with_measurements(reference, *sensor, attributes.reference)
            : reference;
        request.run.as_shot = metadata.as_shot_neutral;
        request.shot = merged(metadata.shot, request.shot);
    } else {
        request.profile = *sensor;
    }
    if (attributes.iso)
        request.shot.iso = int(std::lround(*attributes.iso));
    check_bits(spec, request.profile);
    return request;
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "read_attributes.h"

#include <OpenImageIO/strutil.h>
#include <OpenImageIO/tiffutils.h>

#include <string>

namespace cg2raw {
namespace {

using OIIO::ImageSpec;
using OIIO::TypeDesc;

/// As the type that OpenEXR files keep: it has none for arrays of other lengths.
TypeDesc float_type(std::size_t count)
{
    if (count == 3)
        return OIIO::TypeVector;
    if (count == 9)
        return OIIO::TypeMatrix33;
    return { TypeDesc::FLOAT, int(count) };
}

template <class Numbers>
void add_floats(ImageSpec& spec, const std::string& name, const Numbers& numbers)
{
    const std::vector<float> values(numbers.begin(), numbers.end());
    if (!values.empty())
        spec.attribute(name, float_type(values.size()), values.data());
}

void add_integers(ImageSpec& spec, const std::string& name,
                  const std::vector<int>& values)
{
    spec.attribute(name, TypeDesc(TypeDesc::INT, int(values.size())), values.data());
}

void add_text(ImageSpec& spec, const std::string& name, const std::string& text)
{
    if (!text.empty())
        spec.attribute(name, text);
}

void add_number(ImageSpec& spec, const std::string& name,
                const std::optional<double>& number)
{
    if (number)
        spec.attribute(name, float(*number));
}

/// As OpenImageIO's reader of OpenEXR has them: a frame that is read is one of the shot
/// when it is written again.
void add_place(const Shot& shot, ImageSpec& spec)
{
    if (const auto& rate = shot.frame_rate) {
        const int fraction[2] = { rate->numerator, rate->denominator };
        spec.attribute("FramesPerSecond", OIIO::TypeRational, fraction);
    }
    if (shot.time_code) {
        // SMPTE 331M's bytes are those of a packed one, lowest first.
        const auto bytes = smpte_331m(*shot.time_code, shot.frame_rate);
        std::uint32_t packed[2] = { 0, 0 }; // the second: user data
        for (int i = 3; i >= 0; --i)
            packed[0] = packed[0] << 8 | bytes[std::size_t(i)];
        spec.attribute("smpte:TimeCode", OIIO::TypeTimeCode, packed);
    }
    add_text(spec, "reelName", shot.reel_name);
    add_text(spec, "cameraLabel", shot.camera_label);
}

void add_shot(const Shot& shot, ImageSpec& spec)
{
    spec.attribute("Orientation", shot.orientation);
    add_number(spec, "PixelAspectRatio", shot.pixel_aspect);
    add_number(spec, "ExposureTime", shot.exposure_time);
    add_number(spec, "FNumber", shot.f_number);
    add_number(spec, "Exif:ExposureBiasValue", shot.exposure_bias);
    add_number(spec, "Exif:BrightnessValue", shot.brightness);
    if (shot.exposure_mode)
        spec.attribute("Exif:ExposureMode", int(*shot.exposure_mode));
    add_number(spec, "Exif:FocalLength", shot.focal_length);
    if (shot.iso) { // its name before Exif 2.3, and since: OpenImageIO has both
        spec.attribute("Exif:ISOSpeedRatings", *shot.iso);
        spec.attribute("Exif:PhotographicSensitivity", *shot.iso);
    }
    add_text(spec, "Exif:DateTimeOriginal", shot.date_time_original);
    add_text(spec, "Exif:LensModel", shot.lens_model);
    add_text(spec, "Artist", shot.artist);
    add_text(spec, "Copyright", shot.copyright);
    add_text(spec, "ImageDescription", shot.description);
    add_place(shot, spec);
}

void add_colors(const DngMetadata& metadata, ImageSpec& spec)
{
    if (metadata.as_shot_neutral)
        add_floats(spec, "raw:AsShotNeutral", *metadata.as_shot_neutral);
    int i = 0;
    for (const Calibration& calibration : metadata.calibrations) {
        const std::string number = std::to_string(++i);
        spec.attribute("raw:CalibrationIlluminant" + number, calibration.light_source);
        add_floats(spec, "raw:ColorMatrix" + number, calibration.camera_from_xyz.m);
        if (calibration.xyz_d50_from_camera)
            add_floats(spec, "raw:ForwardMatrix" + number,
                       calibration.xyz_d50_from_camera->m);
    }
    std::vector<double> noise;
    for (const NoisePair& pair : metadata.noise_profile)
        noise.insert(noise.end(), { pair.scale, pair.offset });
    add_floats(spec, "raw:NoiseProfile", noise);
}

void add_levels(const DngMetadata& metadata, const DngStorage& storage, ImageSpec& spec)
{
    const CfaPattern& cfa = metadata.cfa;
    // As OpenImageIO's reader by LibRaw calls it.
    spec.attribute("raw:FilterPattern", name_of(cfa));
    add_integers(spec, "raw:CFARepeatPatternDim", { cfa.height, cfa.width });
    add_floats(spec, "raw:BlackLevel", metadata.black_level);
    spec.attribute("raw:WhiteLevel", metadata.white_level);
    // Not oiio:BitsPerSample, by which writers of other formats would scale values.
    spec.attribute("raw:BitsPerSample", storage.bits);
    spec.attribute("raw:Compression", storage.is_jpeg ? "ljpeg" : "none");
    const auto [top, left] = storage.active_area;
    add_integers(spec, "raw:ActiveArea",
                 { top, left, top + metadata.active_area.height,
                   left + metadata.active_area.width });
    if (storage.default_scale)
        add_floats(spec, "raw:DefaultScale", *storage.default_scale);
    if (storage.crop_origin)
        add_floats(spec, "raw:DefaultCropOrigin", *storage.crop_origin);
    if (storage.crop_size)
        add_floats(spec, "raw:DefaultCropSize", *storage.crop_size);
}

} // namespace

void add_attributes(const DngMetadata& metadata, const DngStorage& storage,
                    ImageSpec& spec)
{
    if (!storage.xmp.empty()) // the tags, which come after, are right where both are
        OIIO::decode_xmp(OIIO::string_view(storage.xmp), spec);
    add_text(spec, "Make", metadata.make);
    add_text(spec, "Model", metadata.model);
    add_text(spec, "Software", storage.software);
    add_text(spec, "DateTime", storage.date_time);
    add_text(spec, "raw:UniqueCameraModel", metadata.unique_camera_model);
    std::string version;
    for (const int part : storage.version)
        version += (version.empty() ? "" : ".") + std::to_string(part);
    spec.attribute("raw:DNGVersion", version);
    add_levels(metadata, storage, spec);
    add_colors(metadata, spec);
    add_shot(metadata.shot, spec);
    if (!metadata.gain_maps.empty())
        spec.attribute("raw:GainMaps", int(metadata.gain_maps.size()));
    add_text(spec, "raw:Notes", OIIO::Strutil::join(metadata.notes, "; "));
}

bool wants_developed(const ImageSpec& config)
{
    bool developed = false;
    for (const OIIO::ParamValue& hint : config.extra_attribs) {
        const std::string name(hint.name().string());
        if (!OIIO::Strutil::istarts_with(name, "dng:"))
            continue;
        if (!OIIO::Strutil::iequals(name, "dng:developed"))
            throw Error("configuration hint " + name
                        + " is unknown to the reader; known: dng:developed");
        const std::string value = hint.get_string();
        if (value != "0" && value != "1")
            throw Error("dng:developed \"" + value
                        + "\" must be 0 (the mosaic) or 1 (a linear Rec.709 picture)");
        developed = value == "1";
    }
    return developed;
}

} // namespace cg2raw

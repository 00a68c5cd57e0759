// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The rules of an export: (facts, options) -> what is decided, or the message.
#include "cg2raw/export.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <sstream>

namespace cg2raw {
namespace {

using Options = std::vector<std::pair<std::string, std::string>>;
using Values = std::vector<std::pair<std::string, Metadata::Value>>;

constexpr int openimageio_2 = 20407, openimageio_3 = 30200;

/// As oiiotool's user types options, and as a function's caller does.
const Dialect attributes { [](std::string_view name, std::string_view value) {
                              const std::string attribute = "dng:" + std::string(name);
                              return value.empty()
                                  ? attribute
                                  : "--attrib " + attribute + " " + std::string(value);
                          },
                           [](const std::string&) { return true; },
                           [] { return std::string("lin_rec709"); },
                           "--iscolorspace lin_rec709", true };
const Dialect keywords { [](std::string_view name, std::string_view value) {
                            return std::string(name) + (value.empty() ? "" : "=")
                                + std::string(value);
                        },
                         [](const std::string&) { return true; },
                         [] { return std::string("lin_rec709"); }, "space=lin_rec709",
                         false };

std::string number(double value)
{
    std::ostringstream text;
    text << value;
    return text.str();
}

template <class T> std::string text(const std::optional<T>& value)
{
    return value ? number(double(*value)) : "-";
}

std::string channels(const SceneLayer& layer)
{
    std::string all = std::to_string(layer.part) + ":";
    for (const int channel : layer.channels)
        all += std::to_string(channel) + ",";
    return all + std::to_string(layer.alpha);
}

/// What is decided, by names.
std::map<std::string, std::string> said_of(const Export& e)
{
    const Run& run = e.run;
    const Shot& shot = e.shot;
    return {
        { "sensor", e.profile.id },
        { "light", run.illuminant },
        { "iso", text(run.iso) },
        { "speed", text(shot.iso) },
        { "exposure", run.exposure ? run.exposure->text : "-" },
        { "luminance", text(run.scene_luminance) },
        { "aperture", text(run.f_number) },
        { "bracket", text(run.bracket) },
        { "bias", text(shot.exposure_bias) },
        { "noise", run.noise_model ? name_of(*run.noise_model) : "-" },
        { "seed", std::to_string(run.seed) },
        { "frame", std::to_string(run.frame) },
        { "gain", run.sample_digital_gain ? "sample" : number(run.digital_gain) },
        { "convention", name_of(run.convention) },
        { "highlights", std::to_string(int(run.keep_highlights)) },
        { "effects", std::to_string(int(run.effects)) },
        { "camera", std::to_string(int(run.camera_input)) },
        { "color_effects", std::to_string(int(run.color_effects)) },
        { "time", text(run.exposure_time) + "/" + text(shot.exposure_time) },
        { "layer", e.layer.name },
        { "channels", channels(e.layer) },
        { "bins", std::to_string(e.bins ? e.bins->channels.size() : 0) },
        { "curve", e.curve.name() },
        { "decoder", e.decoder.is_identity() ? "none" : "some" },
        { "compression", std::to_string(int(e.file.compression)) },
        { "preview", text(e.file.preview) },
        { "matrices", e.file.matrices == Matrices::exact ? "exact" : "camera" },
        { "tone", e.file.tone_curve == ToneCurve::linear ? "linear" : "camera" },
        { "crop", e.file.crop == Crop::none ? "none" : "border" },
        { "shading",
          !e.file.shading                         ? "-"
              : *e.file.shading == Shading::baked ? "baked"
                                                  : "tagged" },
        { "rate", shot.frame_rate ? text_of(*shot.frame_rate) : "-" },
        { "code", shot.time_code ? text_of(*shot.time_code) : "-" },
        { "reel", shot.reel_name },
        { "label", shot.camera_label },
        { "f", text(shot.f_number) },
        { "focal", text(shot.focal_length) },
        { "orientation", std::to_string(shot.orientation) },
        { "aspect", text(shot.pixel_aspect) },
        { "date", shot.date_time_original },
        { "artist", shot.artist },
    };
}

/// An image of one part.
ImageFacts image(const Values& metadata = {}, const std::string& samples = "float",
                 std::vector<std::string> names = { "R", "G", "B" })
{
    ImagePart part { { "", std::move(names) }, samples };
    for (const auto& [name, value] : metadata)
        part.metadata.add(name, value);
    return { { part }, "", "", std::nullopt, 0, openimageio_3, {} };
}

ImageFacts named(const std::string& input, const std::string& output,
                 const Values& metadata = {})
{
    ImageFacts facts = image(metadata);
    facts.input_name = input;
    facts.output_name = output;
    return facts;
}

const std::vector<std::string> bins { "S0.400nm", "S0.500nm", "S0.600nm", "S0.700nm" };

ImageFacts spectra(Values metadata = {}) { return image(metadata, "float", bins); }

ImageFacts measured(Spectrum light)
{
    ImageFacts facts = spectra();
    facts.measured_light
        = [light](const std::string&, const SpectralChannels&) { return light; };
    return facts;
}

ImageFacts parts(const std::vector<std::pair<std::string, std::string>>& named)
{
    ImageFacts facts = image();
    facts.parts.clear();
    for (const auto& [name, channel] : named) {
        const bool is_rgb = channel == "RGB";
        facts.parts.push_back({ { name,
                                  is_rgb ? std::vector<std::string> { "R", "G", "B" }
                                         : std::vector<std::string> { channel } },
                                "half" });
        facts.parts.back().metadata.add("compression", name);
    }
    return facts;
}

ImageFacts deep()
{
    ImageFacts facts = image();
    facts.parts[0].is_flat = false;
    return facts;
}

ImageFacts of_bits(int bits)
{
    ImageFacts facts = image();
    facts.output_bits = bits;
    return facts;
}

ImageFacts of_version(ImageFacts facts, int version)
{
    facts.openimageio_version = version;
    return facts;
}

ImageFacts at_place(ImageFacts facts, std::int64_t place)
{
    facts.place = place;
    return facts;
}

const Options s20 { { "sensor", "samsung-s20fe" }, { "illuminant", "D65" } };
const Options canon { { "sensor", "canon-600d" },
                      { "illuminant", "FL2" },
                      { "white_luminance", "100" } };

/// Options on top of others; an empty value takes one away.
Options with(Options options, const Options& more)
{
    for (const auto& [name, value] : more) {
        const std::string& is = name;
        options.erase(std::remove_if(options.begin(), options.end(),
                                     [&](const auto& o) { return o.first == is; }),
                      options.end());
        if (!value.empty())
            options.emplace_back(name, value);
    }
    return options;
}

Options s20_with(const Options& more) { return with(s20, more); }
Options canon_with(const Options& more) { return with(canon, more); }

/// Aperture and ISO in place of a luminance of white.
Options of_settings(const Options& more)
{
    return with(canon_with({ { "white_luminance", "" },
                             { "f_number", "2" },
                             { "iso", "100" },
                             { "effects", "none" } }),
                more);
}

Export resolved(const ImageFacts& facts, const Options& options,
                const Dialect& dialect = attributes)
{
    ExportOptions set;
    for (const auto& [name, value] : options)
        set.set(name, value, dialect);
    return resolve(facts, set, dialect);
}

std::string failure(const ImageFacts& facts, const Options& options,
                    const Dialect& dialect = attributes)
{
    try {
        resolved(facts, options, dialect);
    } catch (const Error& error) {
        return error.what();
    }
    return "nothing fails";
}

const std::vector<double> rec709 { 0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.329 };
const std::vector<double> ap1 { 0.713, 0.293, 0.165,   0.83,
                                0.128, 0.044, 0.32168, 0.33767 };
constexpr double packed_code = 0x01020304;

/// Facts and options, and what is decided: "name=value" in words, all of which hold.
struct Decision {
    ImageFacts facts;
    Options options;
    const char* decided;
};

const Decision decisions[] = {
    { image(), s20,
      "sensor=samsung-s20fe light=D65 iso=- noise=- seed=0 frame=0 gain=1 "
      "convention=dng highlights=1 effects=1 camera=0 color_effects=1 time=-/- "
      "channels=0:0,1,2,-1 bins=0 curve= decoder=none compression=1 preview=- "
      "matrices=camera tone=camera crop=border shading=- rate=- code=-" },
    // Options, each as it is typed
    { image(),
      s20_with({ { "iso", "800" }, { "noise", "Physical" }, { "seed", " 7 " } }),
      "iso=800 noise=physical seed=7" },
    { image(), s20_with({ { "iso", "800.5" }, { "seed", "18446744073709551615" } }),
      "iso=800.5 seed=18446744073709551615" },
    { image(), s20_with({ { "digital_gain", "0.7" }, { "highlights", "no" } }),
      "gain=0.7 highlights=0" },
    { image(), s20_with({ { "digital_gain", "Sample" }, { "effects", "none" } }),
      "gain=sample effects=0" },
    { image(), s20_with({ { "convention", "paper" }, { "matrices", "exact" } }),
      "convention=paper matrices=exact" },
    { image(), s20_with({ { "tone_curve", "linear" }, { "crop", "none" } }),
      "tone=linear crop=none" },
    { image(), s20_with({ { "preview", "on" }, { "shading", "tagged" } }),
      "preview=1 shading=tagged" },
    { image(), s20_with({ { "Preview", "0" }, { "shading", "baked" } }),
      "preview=0 shading=baked" },
    // Exposure: options, else what the file states
    { image(), s20_with({ { "exposure", "+1.5" } }), "exposure=+1.5 luminance=-" },
    { image(), s20_with({ { "exposure", "Auto" } }), "exposure=Auto" },
    { image(), s20_with({ { "exposure", "random:-1:2" } }), "exposure=random:-1:2" },
    { image({ { "ExposureTime", "1/8" } }), s20_with({ { "exposure_time", "1/4" } }),
      "time=0.25/0.125" },
    { image({ { "FNumber", "4" } }), s20, "aperture=4 f=4" },
    { image({ { "FNumber", "4" } }), s20_with({ { "f_number", "2.8" } }),
      "aperture=2.8 f=4" },
    { image({ { "ExposureTime", "1/8" }, { "FNumber", "4" } }),
      s20_with({ { "iso", "800" }, { "scene_luminance", "100" } }),
      "luminance=100 aperture=4 time=0.125/0.125" },
    { image(), s20_with({ { "bracket", "-2" }, { "exposure_time", "1/4" } }),
      "bracket=-2" },
    { image({ { "cameraFNumber", "8" }, { "cameraFocalLength", "35" } }), s20,
      "f=8 focal=35" },
    { image({ { "isoSpeed", std::vector<double> { 800.0 } } }), s20, "speed=800" },
    { image({ { "Exif:ExposureBiasValue", std::vector<double> { -1.0 } } }), s20,
      "bias=-1" },
    { spectra(), canon_with({ { "exposure", "auto" } }), "exposure=auto bins=4" },
    { spectra(), of_settings({ { "exposure_time", "1/60" } }), "luminance=100 bins=4" },
    { spectra(), of_settings({ { "exposure", "auto" } }), "luminance=100 bins=4" },
    { spectra(), of_settings({ { "white_luminance", "9" } }), "luminance=- bins=4" },
    // Compression: the option, else of an input that is not compressed
    { image({ { "compression", "none" } }), s20, "compression=0" },
    { image({ { "compression", "NONE" } }), s20, "compression=0" },
    { image({ { "compression", "zip" } }), s20, "compression=1" },
    { image({ { "compression", "ljpeg-2d" } }), s20, "compression=2" },
    { image({ { "compression", "none" } }), s20_with({ { "compression", "ljpeg" } }),
      "compression=1" },
    { image({ { "compression", "zip" } }), s20_with({ { "compression", "none" } }),
      "compression=0" },
    // The frame number
    { named("a.0007.exr", "b.0009.dng"), s20, "frame=9" },
    { named("a.0007.exr", "b.dng"), s20, "frame=7" },
    { named("a.exr", "out.-007.dng"), s20, "frame=-7" },
    { named("", "comp_v012.dng"), s20, "frame=0" },
    { named("a.0007.exr", "b.0009.dng"), s20_with({ { "frame", "0" } }), "frame=0" },
    { named("a.0007.exr", "b.dng"), s20_with({ { "frame", "-8" } }), "frame=-8" },
    { named("a.0007.exr", "b.dng", { { "smpte:TimeCode", "01:02:03:04" } }), s20,
      "frame=1020304 code=01:02:03:04" },
    { named("", "b.7.dng", { { "smpte:timecode", std::vector { packed_code, 0.0 } } }),
      s20, "frame=7 code=01:02:03:04" },
    { named("", "b.dng", { { "smpte:TimeCode", std::vector { packed_code, 0.0 } } }),
      s20, "frame=1020304" },
    { named("", "b.dng", { { "smpte:TimeCode", "noon" } }), s20, "frame=0 code=-" },
    // Exif
    { image({ { "ExposureTime", std::vector { 0.25 } },
              { "FNumber", std::vector { 2.5 } },
              { "Exif:FocalLength", std::vector { 35.0 } },
              { "DateTime", "2026:03:04 05:06:07" },
              { "Artist", "A." },
              { "Orientation", std::vector { 6.0 } },
              { "PixelAspectRatio", std::vector { 2.0 } } }),
      s20, "time=0.25/0.25 f=2.5 focal=35 orientation=6 aspect=2 artist=A." },
    { image({ { "ExposureTime", "1/4" }, { "FNumber", "8" } }), s20,
      "time=0.25/0.25 f=8" },
    { image({ { "XResolution", std::vector { 72.0 } },
              { "YResolution", std::vector { 144.0 } } }),
      s20, "aspect=2" },
    { image({ { "YResolution", std::vector { 144.0 } } }), s20, "aspect=-" },
    { image({ { "ExposureTime", std::vector { -1.0 } },
              { "FNumber", std::vector { 1e9 } },
              { "DateTime", "yesterday" },
              { "Orientation", std::vector { 9.0 } } }),
      s20, "time=-/- f=- date= orientation=1" },
    // The place in a shot
    { image({ { "FramesPerSecond", "30000/1001" },
              { "openexr:reelName", "R7" },
              { "cameraLabel", "C" } }),
      s20, "rate=30000/1001 reel=R7 label=C" },
    { image({ { "FramesPerSecond", "0/1" } }), s20, "rate=-" },
    { image({ { "FramesPerSecond", "24/1" }, { "reelName", "R7" } }),
      s20_with({ { "framerate", "23.98" }, { "reel", "A1" }, { "camera_label", "B" } }),
      "rate=24000/1001 reel=A1 label=B" },
    { named("", "b.1003.dng"),
      s20_with({ { "framerate", "24" },
                 { "timecode", "01:00:00:23" },
                 { "first_frame", "1001" } }),
      "code=01:00:01:01" },
    { at_place(named("", "b.1003.dng"), 1),
      s20_with({ { "framerate", "24" }, { "timecode", "01:00:00:23" } }),
      "code=01:00:01:00" },
    { image({ { "FramesPerSecond", "25/1" } }),
      s20_with({ { "timecode", "01:00:00:00" } }), "code=01:00:00:00 rate=25" },
    // Layers and parts
    { image({}, "half", { "B", "G", "R", "A" }), s20, "channels=0:2,1,0,3" },
    { image({}, "half", { "C.R", "C.G", "C.B", "Z" }), s20,
      "layer=C channels=0:0,1,2,-1" },
    { image({}, "half", { "R", "G", "B", "d.R", "d.G", "d.B" }),
      s20_with({ { "layer", "D" } }), "layer=d channels=0:3,4,5,-1" },
    { parts({ { "depth", "Z" }, { "rgba", "RGB" } }), s20, "channels=1:0,1,2,-1" },
    { parts({ { "depth", "Z" }, { "none", "RGB" } }), s20_with({ { "layer", "none" } }),
      "channels=1:0,1,2,-1 compression=0" },
    // What the numbers mean
    { image({ { "oiio:ColorSpace", "lin_rec709" } }, "uint16"), s20,
      "curve= decoder=some" },
    { image({ { "oiio:ColorSpace", "scene_linear" } }), s20, "curve=" },
    { image({ { "oiio:ColorSpace", "sRGB" } }, "uint8"),
      s20_with({ { "linearize", "sRGB" } }), "curve=srgb" },
    { image({ { "chromaticities", rec709 } }), s20, "curve=" },
    { image({ { "chromaticities", ap1 }, { "oiio:ColorSpace", "lin_rec709" } }), s20,
      "curve=" },
    { image({}, "float", { "R", "G", "B", "A" }), s20, "decoder=none" },
    { image({ { "oiio:UnassociatedAlpha", std::vector { 1.0 } } }, "float",
            { "R", "G", "B", "A" }),
      s20, "decoder=some" },
    // RAW already
    { image({ { "oiio:ColorSpace", "RAW - nikon-d40 - 2856K" } }),
      {},
      "sensor=nikon-d40 light=2856K camera=1 color_effects=0 convention=dng" },
    { image({ { "oiio:ColorSpace", "raw_nikon_d40_d65" } }),
      { { "sensor", "nikon-d40" }, { "illuminant", "d65" } },
      "sensor=nikon-d40 light=d65 camera=1" },
    { of_version(image({ { "oiio:ColorSpace", "Linear" },
                         { "colorInteropID", "cg2raw:raw_nikon_d40_a" } }),
                 openimageio_2),
      {},
      "sensor=nikon-d40 light=a camera=1" },
    { image({ { "oiio:ColorSpace", "Linear" },
              { "colorInteropID", "cg2raw:raw_nikon_d40_a" } }),
      s20, "sensor=samsung-s20fe camera=0" },
    { image({ { "oiio:ColorSpace", "RAW - nikon-d40 - A" } }, "uint16"),
      {},
      "curve= decoder=some camera=1" },
    { image({ { "colorInteropID", "cg2raw:raw_nikon_d40_a" } }),
      {},
      "sensor=nikon-d40 light=a camera=1" },
    // Spectra
    { spectra(), canon,
      "bins=4 sensor=canon-600d camera=1 convention=sensor color_effects=1" },
    { spectra({ { "whiteLuminance", std::vector { 100.0 } } }),
      canon_with({ { "white_luminance", "" } }), "bins=4" },
    { spectra({ { "illuminant", "400nm:1;700nm:1" } }),
      canon_with({ { "illuminant", "Estimate" } }), "bins=4" },
    { measured({ { 400, 700 }, { 1, 1 } }),
      canon_with({ { "illuminant", "estimate:mean" } }), "bins=4" },
    { spectra(), canon_with({ { "convention", "spectral" }, { "highlights", "0" } }),
      "convention=sensor" },
    { image({}, "float", { "S0.400nm", "S0.500nm", "p.R", "p.G", "p.B", "S0.600nm" }),
      canon_with({ { "layer", "p" }, { "white_luminance", "" } }),
      "bins=0 channels=0:2,3,4,-1" },
    { image({ { "a.wavelength", std::vector { 4e-7 } },
              { "b.wavelength", std::vector { 5e-7 } } },
            "float", { "a", "b" }),
      canon, "bins=2" },
    // Bits that a host wants
    { of_bits(10), s20, "sensor=samsung-s20fe" },
    { of_bits(16), s20, "sensor=samsung-s20fe" },
};

TEST(Resolve, DecidesByFactsAndOptions)
{
    for (const Decision& row : decisions) {
        SCOPED_TRACE(row.decided);
        std::map<std::string, std::string> said;
        ASSERT_NO_THROW(said = said_of(resolved(row.facts, row.options)))
            << failure(row.facts, row.options);
        std::istringstream words(row.decided);
        for (std::string word; words >> word;) {
            const auto equals = word.find('=');
            const std::string name = word.substr(0, equals);
            ASSERT_TRUE(said.count(name)) << name;
            EXPECT_EQ(said[name], word.substr(equals + 1)) << name;
        }
    }
}

/// Facts and options, and a part of the message.
struct Refusal {
    ImageFacts facts;
    Options options;
    const char* message;
};

const Refusal refusals[] = {
    // Values that no option has
    { image(), s20_with({ { "sensor", "no-such" } }), "samsung-s20fe" },
    { image(), s20_with({ { "sensor", "/nowhere/x.json" } }), "/nowhere/x.json" },
    { image(), s20_with({ { "reference", "/nowhere/x.dng" } }), "/nowhere/x.dng" },
    { image(), s20_with({ { "iso", "0" } }),
      "dng:iso \"0\" must be an ISO from 1 to 10000000" },
    { image(), s20_with({ { "iso", "many" } }), "dng:iso \"many\" must be" },
    { image(), s20_with({ { "seed", "-1" } }), "dng:seed \"-1\" must be a whole" },
    { image(), s20_with({ { "seed", "1.5" } }), "dng:seed" },
    { image(), s20_with({ { "seed", "18446744073709551616" } }), "dng:seed" },
    { image(), s20_with({ { "frame", "x" } }), "dng:frame \"x\" must be a whole" },
    { image(), s20_with({ { "noise", "loud" } }), "dng:noise: " },
    { image(), s20_with({ { "digital_gain", "0" } }),
      "dng:digital_gain \"0\" must be 0.001 to 1000, or sample" },
    { image(), s20_with({ { "digital_gain", "nan" } }), "dng:digital_gain" },
    { image(), s20_with({ { "convention", "adobe" } }), "paper" },
    { image(), s20_with({ { "matrices", "none" } }), "exact" },
    { image(), s20_with({ { "highlights", "2" } }), "must be 0 or 1" },
    { image(), s20_with({ { "effects", "some" } }), "must be profile or none" },
    { image(), s20_with({ { "compression", "zip" } }), "ljpeg" },
    { image(), s20_with({ { "crop", "2" } }), "border or none" },
    { image(), s20_with({ { "tone_curve", "s-shaped" } }), "linear" },
    { image(), s20_with({ { "shading", "none" } }), "tagged or baked" },
    { image(), s20_with({ { "linearize", "rec709" } }), "must be srgb" },
    { image(), s20_with({ { "framerate", "0" } }), "dng:framerate: " },
    { image(), s20_with({ { "timecode", "1h" } }), "hh:mm:ss:ff" },
    { image(), s20_with({ { "colour", "red" } }),
      "dng:colour is unknown; known: dng:sensor, dng:reference" },
    { image({ { "oiio:ColorSpace", "RAW - nikon-d40 - D65" } }),
      { { "reference", "/nowhere/x.dng" } },
      "/nowhere/x.dng" },
    { image(), s20_with({ { "exposure", "bright" } }),
      "dng:exposure: exposure \"bright\" must be stops from -64 to 64, auto" },
    { image(), s20_with({ { "exposure", "random:2:1" } }), "LOW not above HIGH" },
    { image(), s20_with({ { "exposure", "auto:0:1" } }), "a percentile above 0" },
    { image(), s20_with({ { "exposure", "normal:0:-1" } }), "an SD from 0 to 16" },
    { image(), s20_with({ { "exposure", "match:/nowhere/m.json:draw" } }),
      "/nowhere/m.json: " },
    { image(), s20_with({ { "exposure_time", "0" } }), "seconds above 0" },
    { image(), s20_with({ { "exposure_time", "1/0" } }), "seconds above 0" },
    { image(), s20_with({ { "f_number", "0" } }), "a number above 0, such as 2.8" },
    { image(), s20_with({ { "iso_limits", "800:100" } }), "LOW not above HIGH" },
    // Settings of a camera
    { image(), s20_with({ { "scene_luminance", "100" }, { "iso", "100" } }),
      "dng:scene_luminance is given without dng:exposure_time: add --attrib "
      "dng:exposure_time 1/60, or --attrib dng:exposure auto" },
    { image({ { "ExposureTime", "1/8" }, { "FNumber", "4" } }),
      s20_with({ { "scene_luminance", "100" } }), "without dng:iso: add" },
    { image({ { "ExposureTime", "1/8" }, { "FNumber", "4" } }),
      s20_with(
          { { "scene_luminance", "100" }, { "iso", "100" }, { "exposure", "auto" } }),
      "--attrib dng:exposure auto has nothing to find: leave one of" },
    { image(), s20_with({ { "scene_luminance", "100" }, { "exposure", "auto" } }),
      "finds one setting: add --attrib dng:exposure_time 1/60 or" },
    { image(), s20_with({ { "nd_filter", "3" } }), "dng:nd_filter is given without" },
    { image(), s20_with({ { "time_limits", "1/8:1" } }), "dng:time_limits is given" },
    { image(), s20_with({ { "bracket", "2" } }),
      "dng:bracket changes the exposure time, which is not known: add" },
    { image({ { "oiio:ColorSpace", "RAW - nikon-d40 - D65" } }),
      { { "exposure", "1" } },
      "dng:exposure belongs to the conversion" },
    { spectra(), canon_with({ { "scene_luminance", "1" } }), "its luminance is known" },
    // What is missing
    { image(), {}, "which sensor? If its pixels are RAW already, add --iscolorspace" },
    { image(),
      { { "sensor", "nikon-d40" } },
      "under which light? Add --attrib dng:illuminant WORD: " },
    { image(), s20_with({ { "noise", "gaussian" } }),
      "dng:noise is given without dng:iso: add --attrib dng:iso NUMBER" },
    // The place in a shot
    { image(), s20_with({ { "first_frame", "1" } }), "given without dng:timecode" },
    { image(), s20_with({ { "timecode", "01:00:00:00" } }),
      "counts how many frames a second? Add --attrib dng:framerate 24" },
    { named("", "a.1001.dng"),
      s20_with({ { "timecode", "01:00:00:00" }, { "framerate", "24" } }),
      "This one is 1001: add --attrib dng:first_frame NUMBER" },
    { named("", "a.1001.dng"),
      s20_with({ { "timecode", "01:00:00:00" },
                 { "framerate", "24" },
                 { "first_frame", "1002" } }),
      "frame 1001 is before dng:first_frame 1002" },
    { image(), s20_with({ { "timecode", "01:00:00;00" }, { "framerate", "24" } }),
      "drops frame" },
    { image(), s20_with({ { "timecode", "01:00:00:00" }, { "framerate", "120" } }),
      "up to 60" },
    // Channels
    { image({}, "half", { "X", "Y", "Z" }), s20, "--chnames R,G,B" },
    { image({}, "half", { "d.R", "d.G", "d.B", "s.R", "s.G", "s.B" }), s20,
      "Add --attrib dng:layer d," },
    { image({}, "half", { "R", "G", "B" }), s20_with({ { "layer", "M" } }), "M" },
    { image({ { "oiio:subimages", std::vector { 2.0 } } }, "half", { "Z" }), s20,
      "oiiotool --subimage NAME" },
    { image({ { "cryptomatte/1/name", "obj" } }, "half",
            { "obj00.R", "obj00.G", "obj00.B" }),
      s20, "layers are data by their names" },
    { deep(), s20, "flatten first (oiiotool --flatten)" },
    { image({ { "raw:FilterPattern", "RGGB" } }, "uint16", { "Y" }), s20,
      "is RAW already" },
    { image({ { "raw:Unreadable", "lossy JPEG" } }), s20,
      "cannot be read: lossy JPEG" },
    // Colour spaces
    { image({ { "oiio:ColorSpace", "ACEScg" } }), s20,
      "--tocolorspace \"lin_rec709\" (or \"RAW - <sensor> - <illuminant>\")" },
    { image({}, "uint8"), s20, "add --attrib dng:linearize srgb if sRGB's" },
    { image(), s20_with({ { "linearize", "srgb" } }), "linear light by convention" },
    { image({ { "chromaticities", ap1 } }), s20,
      "--iscolorspace ACEScg --tocolorspace \"lin_rec709\"" },
    { of_version(image({ { "chromaticities", ap1 }, { "oiio:ColorSpace", "Linear" } }),
                 openimageio_2),
      s20, "ACEScg" },
    // RAW already
    { image({ { "oiio:ColorSpace", "RAW - samsung-s20fe - D65" } }),
      { { "sensor", "nikon-d40" } },
      "already are \"RAW - samsung-s20fe - D65\", but dng:sensor is nikon-d40" },
    { image({ { "oiio:ColorSpace", "RAW - nikon-d40 - D65" } }),
      { { "illuminant", "A" } },
      "but dng:illuminant is A: leave dng:illuminant out" },
    { image({ { "oiio:ColorSpace", "RAW - nikon-d40 - D65" } }),
      { { "convention", "paper" } },
      "dng:convention belongs to the conversion" },
    { image({ { "oiio:ColorSpace", "RAW - nikon-d40 - D65" } }),
      { { "digital_gain", "0.5" } },
      "dng:digital_gain belongs to the conversion" },
    { image({ { "oiio:ColorSpace", "RAW - nikon-d40 - D65" } }),
      { { "highlights", "1" } },
      "dng:highlights belongs to the conversion" },
    { image({ { "oiio:ColorSpace", "RAW - no-such - D65" } }), {}, "no-such" },
    { image({ { "oiio:ColorSpace", "RAW - nikon-d40 - dusk" } }), {}, "dusk" },
    { image({ { "oiio:ColorSpace", "RAW - nikon-d40 - A" } }, "uint16"),
      { { "linearize", "srgb" } },
      "no curve to undo" },
    { image({ { "oiio:ColorSpace", "lin_ap1_scene" },
              { "colorInteropID", "cg2raw:raw_nikon_d40_a" } }),
      {},
      "which sensor" },
    // Spectra
    { spectra(), canon_with({ { "white_luminance", "" } }),
      "which luminance is white? Add --attrib dng:white_luminance CD_PER_M2" },
    { spectra(), of_settings({}), "such as 100, or dng:exposure_time, dng:f_number" },
    { spectra(), canon_with({ { "illuminant", "" } }), "under which light" },
    { spectra(), canon_with({ { "sensor", "" } }), "which sensor" },
    { spectra(), canon_with({ { "sensor", "nikon-d40" } }),
      "no spectral_sensitivities: make a" },
    { spectra(), canon_with({ { "white_luminance", "0" } }),
      "must be the luminance of white in cd/m2" },
    { spectra(), canon_with({ { "convention", "paper" } }),
      "--attrib dng:convention paper has no meaning" },
    { spectra(), canon_with({ { "digital_gain", "2" } }),
      "dng:digital_gain has no meaning: change dng:exposure" },
    { spectra(), canon_with({ { "highlights", "1" } }),
      "dng:highlights has no meaning" },
    { spectra(), canon_with({ { "linearize", "srgb" } }),
      "dng:linearize has no meaning" },
    { spectra(), canon_with({ { "illuminant", "estimate" } }),
      "the image states no light's spectrum (--attrib illuminant" },
    { spectra(), canon_with({ { "illuminant", "estimate:mean" } }),
      "needs the whole image before its first row" },
    { spectra({ { "illuminant", "tungsten" } }),
      canon_with({ { "illuminant", "estimate" } }),
      "attribute illuminant, the light's spectrum: " },
    { image(), canon,
      "dng:white_luminance is the luminance of white of a spectral image" },
    { image({}, "float", { "", "", "", "" }), canon,
      "of --missingfile black: add --chnames S0.550nm,... as the other frames" },
    { image(), s20_with({ { "illuminant", "estimate" } }),
      "dng:illuminant estimate is for spectral images" },
    { image({}, "float", { "T.400nm", "T.500nm" }), canon, "is a reflectance" },
    // Bits that a host wants
    { of_bits(12), s20, "a sensor of 10 bits (samsung-s20fe) cannot write 12 bits" },
};

TEST(Resolve, RefusesWithTheRemedy)
{
    for (const Refusal& row : refusals) {
        const std::string message = failure(row.facts, row.options);
        EXPECT_NE(message.find(row.message), std::string::npos)
            << row.message << "\nis not in: " << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
}

TEST(Resolve, NamesOptionsAsItsUserDoes)
{
    EXPECT_NE(failure(image(), s20_with({ { "noise", "gaussian" } }), keywords)
                  .find("noise is given without iso: add iso=NUMBER"),
              std::string::npos);
    const ImageFacts layers
        = image({}, "half", { "d.R", "d.G", "d.B", "s.R", "s.G", "s.B" });
    EXPECT_NE(failure(layers, s20, keywords).find("Add layer=d"), std::string::npos);
    const ImageFacts aces = image({ { "oiio:ColorSpace", "ACEScg" } });
    EXPECT_NE(failure(aces, s20, keywords).find("oiiotool --tocolorspace lin_rec709"),
              std::string::npos);
}

TEST(Resolve, LooksIntoAConfigOnlyWhereItIsNeeded)
{
    Dialect dialect = attributes;
    int looks = 0;
    dialect.rec709 = [&] { return ++looks, std::string("lin_rec709"); };
    dialect.is_rec709 = [&](const std::string&) { return ++looks, true; };
    resolved(image({ { "chromaticities", rec709 } }), s20, dialect);
    resolved(image({ { "oiio:ColorSpace", "lin_rec709" } }), s20, dialect);
    resolved(image({ { "oiio:ColorSpace", "RAW - nikon-d40 - A" } }), {}, dialect);
    EXPECT_EQ(looks, 0);
    resolved(image({ { "oiio:ColorSpace", "scene_linear" } }), s20, dialect);
    EXPECT_EQ(looks, 1);
}

TEST(Resolve, OfACameraThatIsDrawnNeedsNoSensor)
{
    const Export picture
        = resolve_picture(named("a.7.exr", "b.dng"), ExportOptions {}, attributes);
    EXPECT_EQ(picture.run.frame, 7);
    EXPECT_EQ(picture.layer.channels, (std::array<int, 3> { 0, 1, 2 }));
}

TEST(ExportOptions, AreOneTable)
{
    const auto& all = export_options();
    EXPECT_EQ(all.size(), 34u);
    for (const ExportOption& option : all) {
        EXPECT_FALSE(std::string(option.allowed).empty()) << option.name;
        EXPECT_FALSE(std::string(option.description).empty()) << option.name;
        const auto same = [&](const ExportOption& other) {
            return std::string(other.name) == option.name;
        };
        EXPECT_EQ(std::count_if(all.begin(), all.end(), same), 1) << option.name;
    }
}

} // namespace
} // namespace cg2raw

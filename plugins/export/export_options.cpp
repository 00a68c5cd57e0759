// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The options of an export: one row is one option. Pages, messages and command
/// lines are made of the table.
#include "cg2raw/export.h"

#include "cg2raw/exposure.h"
#include "core/text.h"

#include <charconv>

namespace cg2raw {
namespace {

std::string stripped(const std::string& text)
{
    constexpr const char* blanks = " \t\r\n\f\v";
    const auto first = text.find_first_not_of(blanks);
    return first == text.npos
        ? ""
        : text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// An option's row, and the text that was given for it.
struct Word {
    const ExportOption& option;
    const Dialect& dialect;
    std::string text;

    std::string name() const { return dialect.option(option.name, ""); }

    [[noreturn]] void fail(const std::string& must) const
    {
        throw Error(name() + " \"" + text + "\" must be " + must);
    }

    double real(double low, double high) const
    {
        const double number = signed_number(text);
        if (!(number >= low && number <= high))
            fail(option.allowed);
        return number;
    }

    template <class Integer> Integer integer() const
    {
        Integer value = 0;
        const char* const end = text.data() + text.size();
        const auto result = std::from_chars(text.data(), end, value);
        if (result.ec != std::errc() || result.ptr != end)
            fail(option.allowed);
        return value;
    }

    bool flag() const
    {
        const std::string word = lower_case(text);
        if (word == "1" || word == "true" || word == "on" || word == "yes")
            return true;
        if (word == "0" || word == "false" || word == "off" || word == "no")
            return false;
        fail(option.allowed);
    }

    /// The result of @p parse, whose error gets this option's name; words in lower
    /// case.
    template <class Parse> auto parsed(const Parse& parse) const
    {
        return exact([&](const std::string&) { return parse(lower_case(text)); });
    }

    /// The same of the text as it is.
    template <class Parse> auto exact(const Parse& parse) const
    {
        try {
            return parse(text);
        } catch (const Error& error) {
            throw Error(name() + ": " + error.what());
        }
    }

    bool is(const char* word) const { return lower_case(text) == word; }
};

struct Row {
    ExportOption option;
    void (*set)(ExportOptions&, const Word&);
};

using Options = ExportOptions;
constexpr const char* frame_numbers
    = "a whole number from -9223372036854775808 to 9223372036854775807";

const Row rows[] = {
    { { "sensor", "exposure", "text", "an id, or a path",
        "a bundled sensor (`cg2raw sensors` lists them) or the path of a profile "
        "(.json)" },
      [](Options& o, const Word& w) { o.sensor = w.text; } },
    { { "reference", "exposure", "text", "a path",
        "a DNG of the target camera, in place of a sensor: levels, CFA, matrices, "
        "model and Exif are its own" },
      [](Options& o, const Word& w) { o.reference = w.text; } },
    { { "illuminant", "exposure", "text",
        "A, D65, 3200K, sample:7, measured:7, as-shot ...; estimate of spectral images",
        "the light: [see below](#illuminants)" },
      [](Options& o, const Word& w) { o.illuminant = w.text; } },
    { { "iso", "exposure", "number", "an ISO from 1 to 10000000",
        "adds the sensor's noise at this ISO, up to one stop beyond the measured ones "
        "(of a sensor measured at one ISO, this one only); without it the file is "
        "clean" },
      [](Options& o, const Word& w) { o.iso = w.real(1.0, 1e7); } },
    { { "exposure", "exposure", "text",
        "stops, auto, auto:PERCENTILE:LEVEL, random:LOW:HIGH, normal:MEAN:SD, "
        "match:FILE or match:FILE:draw",
        "stops by which the scene is brightened before anything clips: a number, "
        "metered (`auto`; `match`, by what `cg2raw match` wrote), or drawn by seed and "
        "frame ([exposure.md](exposure.md))" },
      [](Options& o, const Word& w) { o.exposure = w.exact(exposure_from_text); } },
    { { "exposure_time", "exposure", "text", "seconds above 0, such as 0.5 or 1/60",
        "Exif's ExposureTime, and what dark current grows by. Default: the file's "
        "`ExposureTime`" },
      [](Options& o, const Word& w) { o.exposure_time = w.exact(seconds_from_text); } },
    { { "f_number", "exposure", "number", "a number above 0, such as 2.8",
        "Exif's FNumber. Default: the file's `FNumber`" },
      [](Options& o, const Word& w) { o.f_number = w.real(0.01, 1e6); } },
    { { "scene_luminance", "exposure", "number",
        "the luminance of the value 1 in cd/m2, above 0",
        "makes brightness follow `exposure_time`, `f_number` and `iso`, as in a "
        "camera; "
        "with `exposure` `auto` the one of them that is missing is found "
        "([exposure.md](exposure.md#settings-of-a-camera))" },
      [](Options& o, const Word& w) { o.scene_luminance = w.real(1e-6, 1e12); } },
    { { "nd_filter", "exposure", "number", "stops from -64 to 64",
        "of a neutral density filter before the lens, with `scene_luminance`" },
      [](Options& o, const Word& w) { o.nd_filter = w.real(-64.0, 64.0); } },
    { { "iso_limits", "exposure", "text", "LOW:HIGH, such as 100:6400",
        "of the ISO that `exposure` `auto` finds. Default: the calibrated ones" },
      [](Options& o, const Word& w) { o.iso_limits = w.exact(limits_from_text); } },
    { { "time_limits", "exposure", "text", "LOW:HIGH, such as 1/8000:1/30",
        "of the exposure time that it finds. Default: `1/8000:30`" },
      [](Options& o, const Word& w) { o.time_limits = w.exact(limits_from_text); } },
    { { "f_number_limits", "exposure", "text", "LOW:HIGH, such as 1.4:16",
        "of the aperture that it finds. Default: `1:32`" },
      [](Options& o, const Word& w) {
          o.f_number_limits = w.exact(limits_from_text);
      } },
    { { "bracket", "exposure", "number", "stops from -64 to 64",
        "makes the file one of a bracket: its exposure time is longer by so many "
        "stops" },
      [](Options& o, const Word& w) { o.bracket = w.real(-64.0, 64.0); } },
    { { "noise", "exposure", "word", "gaussian or physical",
        "`physical`: Poisson photons, Tukey lambda read noise, row noise (Wei et al.), "
        "if the profile has their parameters. Default: the profile's `noise_effects`, "
        "else `gaussian`" },
      [](Options& o, const Word& w) { o.noise = w.parsed(noise_model_from_name); } },
    { { "seed", "exposure", "integer", "a whole number from 0 to 18446744073709551615",
        "default 0; the same seed gives the same bytes on any machine. From 2147483647 "
        "on as `--attrib:type=string`" },
      [](Options& o, const Word& w) { o.seed = w.integer<std::uint64_t>(); } },
    { { "frame", "exposure", "integer", frame_numbers,
        "noise differs between frames, fixed patterns do not. Default: the number in "
        "the output's name (`shot.0007.dng`, `render0007.dng`; not a version, as in "
        "`comp_v002.dng`), else `smpte:TimeCode`, else, in `convert`, the number in "
        "the input's name, else 0" },
      [](Options& o, const Word& w) { o.frame = w.integer<std::int64_t>(); } },
    { { "linearize", "input", "word", "srgb",
        "undo the curve of sRGB: [what the numbers "
        "mean](#what-the-numbers-of-an-image-mean)" },
      [](Options& o, const Word& w) {
          if (!w.is("srgb"))
              w.fail(w.option.allowed);
          o.undo = Undo::srgb;
      } },
    { { "layer", "input", "text", "a name",
        "which layer or part is the picture. Default: R, G, B without a layer, else "
        "the layer `rgba`, `rgb`, `beauty`, `C`, `Ci` or `Combined`, alone or as in "
        "`ViewLayer.Combined`. If this leaves a choice, an error lists the layers; "
        "those that are data by their names (normals, ids, depth, Cryptomatte) come "
        "last. A layer that is named may have the channels x, y, z or 0, 1, 2. A "
        "picture without names of channels, such as `--missingfile black`, is R, G, B "
        "whatever the layer" },
      [](Options& o, const Word& w) { o.layer = w.text; } },
    { { "white_luminance", "input", "number",
        "the luminance of white in cd/m2, above 0",
        "of a spectral image (channels `S0.550,0nm` ...), unless the file has "
        "`whiteLuminance` ([spectral.md](spectral.md))" },
      [](Options& o, const Word& w) { o.white_luminance = w.real(1e-6, 1e12); } },
    { { "digital_gain", "exposure", "number", "0.001 to 1000, or sample",
        "multiplies the white balance before highlights are protected, as in the "
        "paper, so that white stays white; `sample` draws it from the sensor's "
        "profile. "
        "Default: 1. `exposure` changes the light" },
      [](Options& o, const Word& w) {
          o.sample_digital_gain = w.is("sample");
          if (!o.sample_digital_gain)
              o.digital_gain = w.real(0.001, 1000.0);
      } },
    { { "convention", "exposure", "word", "dng, paper, sensor or spectral",
        "`dng` (default): the exact inverse of a DNG renderer. `paper`: comparable "
        "with the published method. `sensor`: as a camera records light, with a hard "
        "clip at white and noise on every pixel; `cg2raw diagnose` compares with it. "
        "`spectral`: `sensor`, with colours by the sensor's spectral sensitivities "
        "([spectral.md](spectral.md))" },
      [](Options& o, const Word& w) {
          o.convention = w.parsed(convention_from_name);
      } },
    { { "highlights", "exposure", "flag", "0 or 1",
        "1 (default) keeps white white, 0 does not; not with the conventions `sensor` "
        "and `spectral`" },
      [](Options& o, const Word& w) { o.highlights = w.flag(); } },
    { { "matrices", "file", "word", "camera or exact",
        "`camera` (default): the sensor's own. `exact`: every reader recovers the "
        "render" },
      [](Options& o, const Word& w) {
          o.file.matrices = w.parsed(matrices_from_name);
      } },
    { { "effects", "exposure", "word", "profile or none",
        "of the sensor; default: `profile`" },
      [](Options& o, const Word& w) {
          if (!w.is("profile") && !w.is("none"))
              w.fail(w.option.allowed);
          o.effects = w.is("profile");
      } },
    { { "compression", "file", "word", "ljpeg, ljpeg-2d or none",
        "`ljpeg`: lossless. `ljpeg-2d`: a predictor for each tile, smaller, but "
        "darktable does not open it. Default: `none` if `--compression none` is given "
        "or the input is not compressed, else `ljpeg`" },
      [](Options& o, const Word& w) {
          o.compression = w.parsed(compression_from_name);
      } },
    { { "preview", "file", "flag", "0 or 1",
        "an 8-bit picture in the file. Default: 1, but 0 for frames of a shot" },
      [](Options& o, const Word& w) { o.file.preview = w.flag(); } },
    { { "crop", "file", "word", "border or none",
        "`border` (default): converters omit 2 pixels on each side, where demosaicing "
        "lacks neighbours. `none`: they show all" },
      [](Options& o, const Word& w) { o.file.crop = w.parsed(crop_from_name); } },
    { { "tone_curve", "file", "word", "camera or linear",
        "`camera` (default): the reader applies its own; `linear`: none" },
      [](Options& o, const Word& w) {
          o.file.tone_curve = w.parsed(tone_curve_from_name);
      } },
    { { "framerate", "shot", "text", "24, 23.976, 24000/1001 ...",
        "makes the file a frame of a shot, CinemaDNG: [sequences.md](sequences.md). "
        "Default: `FramesPerSecond`" },
      [](Options& o, const Word& w) {
          o.frame_rate = w.parsed(frame_rate_from_text);
      } },
    { { "timecode", "shot", "text", "hh:mm:ss:ff, or hh:mm:ss;ff",
        "that of the frame `first_frame`. Default: `smpte:TimeCode`" },
      [](Options& o, const Word& w) { o.time_code = w.parsed(time_code_from_text); } },
    { { "first_frame", "shot", "integer", frame_numbers,
        "the number of the shot's first frame" },
      [](Options& o, const Word& w) { o.first_frame = w.integer<std::int64_t>(); } },
    { { "reel", "shot", "text", "a name", "ReelName of a frame. Default: `reelName`" },
      [](Options& o, const Word& w) { o.reel = w.text; } },
    { { "camera_label", "shot", "text", "a name",
        "CameraLabel of a frame. Default: `cameraLabel`" },
      [](Options& o, const Word& w) { o.camera_label = w.text; } },
    { { "shading", "shot", "word", "tagged or baked",
        "lens shading: `tagged`, GainMaps undo it; `baked`, nothing does. Default: "
        "`tagged`, but `baked` in frames of a shot" },
      [](Options& o, const Word& w) { o.file.shading = w.parsed(shading_from_name); } },
};

} // namespace

const std::vector<ExportOption>& export_options()
{
    static const std::vector<ExportOption> options = [] {
        std::vector<ExportOption> all;
        for (const Row& row : rows)
            all.push_back(row.option);
        return all;
    }();
    return options;
}

void ExportOptions::set(std::string_view name, const std::string& text,
                        const Dialect& dialect)
{
    const std::string lower = lower_case(name);
    std::string known;
    for (const Row& row : rows) {
        if (row.option.name == lower) {
            row.set(*this, { row.option, dialect, stripped(text) });
            return;
        }
        known += (known.empty() ? "" : ", ") + dialect.option(row.option.name, "");
    }
    throw Error(dialect.option(name, "") + " is unknown; known: " + known);
}

} // namespace cg2raw

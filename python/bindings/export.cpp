// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/export.h"

#include "bindings.h"
#include "cg2raw/exposure.h"
#include "cg2raw/light_meter.h"
#include "constructor.h"

#include <pybind11/functional.h>

namespace cg2raw::python {
namespace {

using Stated = std::map<std::string, std::variant<std::string, std::vector<double>>>;
/// Of one image of a file: its name, channels, type of samples, whether it is flat, and
/// what it states.
using Part
    = std::tuple<std::string, std::vector<std::string>, std::string, bool, Stated>;
using Measure = std::function<Rows(const std::string&, const SpectralChannels&)>;

ImageFacts facts(const std::vector<Part>& parts, std::string input_name,
                 std::string output_name, int openimageio_version,
                 std::optional<std::int64_t> place,
                 const std::optional<Measure>& measured_light)
{
    ImageFacts facts { {},
                       std::move(input_name),
                       std::move(output_name),
                       place,
                       0,
                       openimageio_version,
                       {} };
    for (const auto& [name, channels, samples, is_flat, stated] : parts) {
        facts.parts.push_back({ { name, channels }, samples, is_flat });
        Metadata& metadata = facts.parts.back().metadata;
        for (const auto& [key, value] : stated)
            std::visit([&, &key = key](const auto& one) { metadata.add(key, one); },
                       value);
    }
    if (facts.parts.empty())
        throw Error("an image has one part or more");
    if (measured_light)
        facts.measured_light
            = [measure = *measured_light](const std::string& word,
                                          const SpectralChannels& bins) {
                  return spectrum_from_rows(measure(word, bins));
              };
    return facts;
}

ExportOptions options(const std::map<std::string, std::string>& given,
                      const Dialect& dialect, const std::string& undo)
{
    ExportOptions options;
    options.undo = undo_from_name(undo);
    for (const auto& [name, text] : given)
        options.set(name, text, dialect);
    return options;
}

/// What decides the frame, but for its camera and light.
py::dict frame_of(const Run& run)
{
    const auto pair = [](const std::optional<Limits>& limits) {
        using Pair = std::array<double, 2>;
        return limits ? std::optional(Pair { limits->low, limits->high })
                      : std::nullopt;
    };
    return py::dict(
        "iso"_a = run.iso,
        "exposure"_a = run.exposure ? std::optional(run.exposure->text) : std::nullopt,
        "exposure_time"_a = run.exposure_time, "f_number"_a = run.f_number,
        "scene_luminance"_a = run.scene_luminance, "nd_filter"_a = run.nd_filter,
        "iso_limits"_a = pair(run.iso_limits), "time_limits"_a = pair(run.time_limits),
        "f_number_limits"_a = pair(run.f_number_limits), "bracket"_a = run.bracket,
        "noise"_a = run.noise_model
            ? std::optional<std::string>(name_of(*run.noise_model))
            : std::nullopt,
        "seed"_a = run.seed, "frame"_a = run.frame,
        "highlights"_a = run.keep_highlights, "effects"_a = run.effects);
}

} // namespace

void bind_export(py::module_& m)
{
    m.def(
        "export_options",
        [] {
            std::vector<std::array<std::string, 5>> all;
            for (const ExportOption& option : export_options())
                all.push_back({ option.name, option.group, option.type, option.allowed,
                                option.description });
            return all;
        },
        "(name, group, type, what is allowed, description in Markdown) of each option "
        "of an "
        "export.");
    py::class_<Dialect> dialect(m, "Dialect", "How messages name options.");
    def_constructor(
        dialect,
        +[](const std::function<std::string(std::string, std::string)>& option,
            std::function<bool(std::string)> is_rec709, const std::string& rec709,
            std::string is_linear) {
            return Dialect { [option](std::string_view name, std::string_view value) {
                                return option(std::string(name), std::string(value));
                            },
                             std::move(is_rec709), [rec709] { return rec709; },
                             std::move(is_linear), false };
        },
        "option"_a, "is_rec709"_a, "rec709"_a, "is_linear"_a,
        "option : (name, value) -> the option as it is typed; value may be empty. "
        "is_rec709 :\nwhether linear or scene_linear is, in the current config. rec709 "
        ": a space that is.\nis_linear : what says that pixels are linear.");
    py::class_<ImageFacts> of_image(
        m, "ImageFacts", "What is known of an image before its first pixel.");
    def_constructor(of_image, &facts, "parts"_a, "input_name"_a, "output_name"_a,
                    "openimageio_version"_a, "place"_a = py::none(),
                    "measured_light"_a = py::none(),
                    "parts : (name, channels, type of samples, whether it is flat, "
                    "{attribute:\ntext or numbers}) of each image of the file. place : "
                    "frames from the first of the\nshot. measured_light : word -> "
                    "[(nm, power)] of the whole image.");
    py::class_<ExportOptions> of_user(m, "ExportOptions", "What a user asks for.");
    def_constructor(of_user, &options, "given"_a, "dialect"_a, "undo"_a = "none",
                    "given : {name: text}, of export_options(). undo : none, srgb, "
                    "stated or\nstated-or-srgb. Raises Error.");
    // Copies: pybind11 ends the process if it lacks the memory to note what keeps what.
    py::class_<Export>(m, "Export", "Everything that decides a DNG.")
        .def_property_readonly(
            "layer", [](const Export& e) { return e.layer; }, "The channels to take.")
        .def_property_readonly(
            "undone", [](const Export& e) { return e.curve.name(); },
            "The curve that is undone: srgb, g2.2, or nothing.")
        .def_property_readonly("decoder", [](const Export& e) { return e.decoder; })
        .def_property_readonly(
            "bins", [](const Export& e) { return e.bins; },
            "Of spectra, which are taken instead.")
        .def_property_readonly(
            "spectral",
            [](const Export& e) {
                return e.spectral ? std::optional(e.spectral->of_bins_alone())
                                  : std::nullopt;
            },
            "The SpectralResponse of pixels that hold the bins alone.")
        .def_property_readonly("shot", [](const Export& e) { return e.shot; })
        .def_property_readonly(
            "run", [](const Export& e) { return frame_of(e.run); },
            "Its fields but for camera, light and gains.")
        .def(
            "simulation",
            [](const Export& e, const py::array& rgb, int threads) {
                const Scene scene(rgb);
                const py::gil_scoped_release release;
                const Run run = metered(e.profile, e.run, scene.size(), scene.rows(),
                                        parallel_threads(threads));
                return Simulation(e.profile, run, scene.size());
            },
            "rgb"_a, "threads"_a = 0, "The Simulation of an image.")
        .def(
            "write",
            [](const Export& e, const std::string& path, const RawArray& raw,
               const Simulation& simulation, int threads) {
                write_frame(path, raw, simulation, e.file, e.shot, threads, true);
            },
            "path"_a, "raw"_a, "simulation"_a, "threads"_a = 0,
            "Write the DNG of a frame that was simulated.");
    m.def("picture_layer", &picture_layer, "facts"_a, "options"_a, "dialect"_a,
          "The SceneLayer that is the picture of a file. Raises Error.");
    m.def(
        "spectral_bins",
        [](const ImageFacts& image) { return spectral_bins(image.parts.front()); },
        "facts"_a,
        "The SpectralChannels of the first image of a file, or None. Raises Error.");
    m.def(
        "stated_shot",
        [](const ImageFacts& image) {
            return stated_shot(image.parts.front().metadata);
        },
        "facts"_a, "What the first image of a file says of its exposure and its shot.");
    m.def(
        "stated_light",
        [](const ImageFacts& image) -> std::optional<Rows> {
            const auto light = stated_light(image.parts.front().metadata);
            return light ? std::optional(rows_of(*light)) : std::nullopt;
        },
        "facts"_a,
        "[(nm, power)] of the light that the first image of a file states, or None.\n"
        "Raises Error for a text that is no spectrum.");
    m.def(
        "stated_white",
        [](const ImageFacts& image) {
            return stated_white(image.parts.front().metadata);
        },
        "facts"_a,
        "The luminance of white, cd/m2, that the first image of a file states, or "
        "None.");
    m.def(
        "exposure_stops",
        [](const SensorProfile& profile, const Run& run, const Dialect& dialect) {
            return settle(profile, run, dialect.option).gain_stops;
        },
        "profile"_a, "run"_a, "dialect"_a,
        "Stops by which scene-linear values are changed, but for a bracket's. Raises "
        "Error,\nin the words of a dialect.");
    m.def("resolve", &resolve, "facts"_a, "options"_a, "dialect"_a,
          "Decide all of an export. Raises Error.");
    m.def("resolve_picture", &resolve_picture, "facts"_a, "options"_a, "dialect"_a,
          "The same without a camera: the picture, its frame number and its shot.");
}

} // namespace cg2raw::python

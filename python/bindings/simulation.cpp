// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "bindings.h"
#include "constructor.h"

#include "cg2raw/exposure.h"
#include "cg2raw/light_meter.h"

#include <variant>

namespace cg2raw::python {
namespace {

/// Where a pixel stands decides its filter and its noise.
void check_size(const Simulation& simulation, const Scene& scene)
{
    const Size have = scene.size(), want = simulation.frame();
    if (have.width != want.width || have.height != want.height)
        throw Error("image of " + std::to_string(have.height) + " x "
                    + std::to_string(have.width)
                    + " pixels must be as large as its simulation, "
                    + std::to_string(want.height) + " x " + std::to_string(want.width));
}

/// As people write it, or a number.
using NumberOrText = std::variant<double, std::string>;
using LimitsOrText = std::variant<std::array<double, 2>, std::string>;

std::string text_of(const NumberOrText& value)
{
    const auto* const number = std::get_if<double>(&value);
    return number ? std::string(py::str(py::float_(*number)))
                  : std::get<std::string>(value);
}

std::string text_of(const LimitsOrText& value)
{
    const auto* const pair = std::get_if<std::array<double, 2>>(&value);
    return pair
        ? text_of(NumberOrText((*pair)[0])) + ":" + text_of(NumberOrText((*pair)[1]))
        : std::get<std::string>(value);
}

std::optional<double> seconds_of(const std::optional<NumberOrText>& value)
{
    if (!value || std::holds_alternative<double>(*value))
        return value ? std::optional(std::get<double>(*value)) : std::nullopt;
    try {
        return seconds_from_text(std::get<std::string>(*value));
    } catch (const Error& error) {
        throw Error("exposure_time " + std::string(error.what()));
    }
}

std::optional<Limits> limits_of(const std::optional<LimitsOrText>& value,
                                const char* name)
{
    try {
        return value ? std::optional(limits_from_text(text_of(*value))) : std::nullopt;
    } catch (const Error& error) {
        throw Error(name + std::string(" ") + error.what());
    }
}

std::optional<LimitsOrText> argument_of(const std::optional<Limits>& limits)
{
    if (!limits)
        return std::nullopt;
    return LimitsOrText(std::array<double, 2> { limits->low, limits->high });
}

Run run_of(const std::string& illuminant, std::optional<double> iso,
           const std::optional<std::string>& noise, std::uint64_t seed,
           std::int64_t frame, double digital_gain, const std::string& convention,
           bool highlights, bool effects, bool camera_input,
           const std::optional<Vec3>& as_shot, bool sample_digital_gain,
           const std::optional<NumberOrText>& exposure_time, bool color_effects,
           const std::optional<NumberOrText>& exposure, std::optional<double> f_number,
           std::optional<double> scene_luminance, double nd_filter,
           const std::optional<LimitsOrText>& iso_limits,
           const std::optional<LimitsOrText>& time_limits,
           const std::optional<LimitsOrText>& f_number_limits,
           std::optional<double> bracket, std::optional<double> meter)
{
    Run run;
    run.illuminant = illuminant;
    run.iso = iso;
    if (noise)
        run.noise_model = noise_model_from_name(*noise);
    run.seed = seed;
    run.frame = frame;
    run.digital_gain = digital_gain;
    run.convention = convention_from_name(convention);
    run.keep_highlights = highlights;
    run.effects = effects;
    run.camera_input = camera_input;
    run.as_shot = as_shot;
    run.sample_digital_gain = sample_digital_gain;
    run.exposure_time = seconds_of(exposure_time);
    run.color_effects = color_effects;
    if (exposure)
        run.exposure = exposure_from_text(text_of(*exposure));
    run.f_number = f_number;
    run.scene_luminance = scene_luminance;
    run.nd_filter = nd_filter;
    run.iso_limits = limits_of(iso_limits, "iso_limits");
    run.time_limits = limits_of(time_limits, "time_limits");
    run.f_number_limits = limits_of(f_number_limits, "f_number_limits");
    run.bracket = bracket;
    run.meter = meter;
    return run;
}

/// The arguments of run_of.
py::tuple remade(const Run& run)
{
    std::optional<std::string> noise;
    if (run.noise_model)
        noise = name_of(*run.noise_model);
    return remade_as<Run>(
        run.illuminant, run.iso, noise, run.seed, run.frame, run.digital_gain,
        name_of(run.convention), run.keep_highlights, run.effects, run.camera_input,
        run.as_shot, run.sample_digital_gain, run.exposure_time, run.color_effects,
        run.exposure ? std::optional(run.exposure->text) : std::nullopt, run.f_number,
        run.scene_luminance, run.nd_filter, argument_of(run.iso_limits),
        argument_of(run.time_limits), argument_of(run.f_number_limits), run.bracket,
        run.meter);
}

RawArray raw_of(const Simulation& simulation, const py::array& rgb, int threads)
{
    const Scene scene(rgb);
    check_size(simulation, scene);
    RawFrame frame;
    {
        const py::gil_scoped_release release;
        frame = simulate(scene.rows(), simulation, parallel_threads(threads));
    }
    auto* const dn = new std::vector<std::uint16_t>(std::move(frame.dn));
    const py::capsule owner(
        dn, [](void* p) { delete static_cast<std::vector<std::uint16_t>*>(p); });
    return RawArray({ frame.height, frame.width }, dn->data(), owner);
}

FloatArray signal_of(const Simulation& simulation, const py::array& rgb, int threads)
{
    const Scene scene(rgb);
    check_size(simulation, scene);
    FloatArray signal({ scene.size().height, scene.size().width });
    const Plane<float> plane = plane_of(signal);
    const py::gil_scoped_release release;
    simulate(scene.rows(), simulation, plane, parallel_threads(threads));
    return signal;
}

/// Mean and variance, (height, width) each.
std::pair<FloatArray, FloatArray> prediction_of(const Simulation& simulation,
                                                const py::array& rgb, int threads)
{
    const Scene scene(rgb);
    check_size(simulation, scene);
    FloatArray mean({ scene.size().height, scene.size().width });
    FloatArray variance({ scene.size().height, scene.size().width });
    const Plane<float> means = plane_of(mean), variances = plane_of(variance);
    {
        const py::gil_scoped_release release;
        predict(scene.rows(), simulation, means, variances, parallel_threads(threads));
    }
    return { mean, variance };
}

/// (height, width, 3) of a function from a row of pixels to three planes of a row.
template <class Convert>
FloatArray converted(const py::array& rgb, int threads, const Convert& convert)
{
    const Scene scene(rgb);
    const auto [width, height] = scene.size();
    FloatArray out({ height, width, 3 });
    float* const pixels = out.mutable_data();
    const py::gil_scoped_release release;
    each_strip(
        scene.rows(), scene.size(), parallel_threads(threads),
        [&](const RgbView& part, int first, Illegal& illegal) {
            std::vector<float> room(std::size_t(3) * std::size_t(part.width));
            float* const planes[3] = { room.data(), room.data() + part.width,
                                       room.data() + 2 * std::ptrdiff_t(part.width) };
            for (int row = 0; row < part.height; ++row) {
                convert(part.row(row), part.pixel_stride, part.width, planes, illegal);
                interleave(planes, part.width,
                           pixels + std::ptrdiff_t(first + row) * part.width * 3);
            }
        });
    return out;
}

FloatArray camera_of(const CameraTransform& transform, const py::array& rgb,
                     int threads)
{
    return converted(rgb, threads,
                     [&](auto&&... row) { to_camera(transform, row...); });
}

FloatArray scene_of(const CameraTransform& transform, const py::array& camera,
                    int threads)
{
    const SceneTransform back = scene_from_camera(transform);
    return converted(camera, threads, [&](auto&&... row) { to_scene(back, row...); });
}

} // namespace

void bind_simulation(py::module_& m)
{
    py::class_<Run> run(m, "Run", "What one exposure is asked to be.");
    def_constructor(run, &run_of, "illuminant"_a, "iso"_a, "noise"_a, "seed"_a,
                    "frame"_a, "digital_gain"_a, "convention"_a, "highlights"_a,
                    "effects"_a, "camera_input"_a, "as_shot"_a,
                    "sample_digital_gain"_a = false, "exposure_time"_a = std::nullopt,
                    "color_effects"_a = true, "exposure"_a = std::nullopt,
                    "f_number"_a = std::nullopt, "scene_luminance"_a = std::nullopt,
                    "nd_filter"_a = 0.0, "iso_limits"_a = std::nullopt,
                    "time_limits"_a = std::nullopt, "f_number_limits"_a = std::nullopt,
                    "bracket"_a = std::nullopt, "meter"_a = std::nullopt);
    run.def("__reduce__", &remade);
    run.def_readonly("meter", &Run::meter, "What a light meter read; None: nothing.")
        .def_property_readonly("needs_meter", &needs_meter,
                               "Whether its exposure is that of a light meter.");
    py::class_<Simulation> simulation(
        m, "Simulation",
        "A sensor, a light and an exposure, decided before any pixel.");
    def_constructor(
        simulation,
        +[](const SensorProfile& profile, std::array<int, 2> shape, const Run& asked) {
            return Simulation(profile, asked, { shape[1], shape[0] });
        },
        "profile"_a, "shape"_a, "run"_a);
    simulation
        .def("__reduce__",
             [](const Simulation& s) {
                 const std::array<int, 2> shape { s.frame().height, s.frame().width };
                 return remade_as<Simulation>(s.profile(), shape, s.run());
             })
        // Not a reference: pybind11 ends the process if it lacks the memory to note
        // that one keeps the simulation alive.
        .def_property_readonly("illuminant", &Simulation::illuminant,
                               py::return_value_policy::copy,
                               "The light, as the sensor sees it.")
        .def_property_readonly(
            "spectrum", &Simulation::spectrum,
            "What convention spectral takes for the light's spectrum, in words; else "
            "empty.")
        .def_property_readonly(
            "exposure",
            [](const Simulation& s) {
                const SettledExposure& e = s.exposure();
                const Run& run = s.run();
                return py::dict(
                    "stops"_a = e.gain_stops,
                    "rule"_a
                    = run.exposure ? std::optional(run.exposure->text) : std::nullopt,
                    "exposure_time"_a = e.exposure_time, "f_number"_a = e.f_number,
                    "iso"_a = e.iso, "scene_luminance"_a = run.scene_luminance,
                    "bracket"_a = run.bracket, "meter"_a = run.meter);
            },
            "stops by which scene-linear values are changed, but for a bracket's, the "
            "rule that\ndecided them, and the settings that were given or found; None "
            "where there is none.")
        .def_property_readonly("digital_gain", &Simulation::digital_gain,
                               "What multiplies the white balance gains.")
        .def(
            "raw", &raw_of, "rgb"_a, "threads"_a = 0,
            "(height, width) uint16 DN of a (height, width, 3 or 4) float32 or float16 "
            "image.")
        .def("signal", &signal_of, "rgb"_a, "threads"_a = 0,
             "(height, width) float32 before quantisation, 0..1 above black, not "
             "clamped.")
        .def("predict", &prediction_of, "rgb"_a, "threads"_a = 0,
             "(mean, variance) of that signal, (height, width) float32 each.");
    m.def("seconds_from_text", &seconds_from_text, "text"_a,
          "0.5 or 1/60 as seconds. Raises Error.");
    m.def(
        "metered",
        [](const SensorProfile& profile, const Run& run, const py::array& rgb,
           int threads) {
            const Scene scene(rgb);
            const py::gil_scoped_release release;
            return metered(profile, run, scene.size(), scene.rows(),
                           parallel_threads(threads));
        },
        "profile"_a, "run"_a, "rgb"_a, "threads"_a = 0,
        "The Run with its light meter read of a whole image, if its exposure needs "
        "one.");
    m.def("to_camera", &camera_of, "transform"_a, "rgb"_a, "threads"_a = 0,
          "(height, width, 3) float32 camera RGB of a scene-linear image.");
    m.def("to_scene", &scene_of, "transform"_a, "camera"_a, "threads"_a = 0,
          "(height, width, 3) float32 scene-linear Rec.709 of camera RGB: the way back "
          "of the\ntransform, as the processor of a camera takes it.");
}

} // namespace cg2raw::python

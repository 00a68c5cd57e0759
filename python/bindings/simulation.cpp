// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "bindings.h"

namespace cg2raw::python {
namespace {

Run run_of(const std::string& illuminant, std::optional<double> iso,
           const std::string& noise, std::uint64_t seed, std::uint64_t frame,
           double digital_gain, const std::string& convention, bool highlights,
           bool effects, bool camera_input, const std::optional<Vec3>& as_shot,
           bool sample_digital_gain)
{
    Run run;
    run.illuminant = illuminant;
    run.iso = iso;
    run.noise_model = noise_model_from_name(noise);
    run.seed = seed;
    run.frame = frame;
    run.digital_gain = digital_gain;
    run.convention = convention_from_name(convention);
    run.keep_highlights = highlights;
    run.effects = effects;
    run.camera_input = camera_input;
    run.as_shot = as_shot;
    run.sample_digital_gain = sample_digital_gain;
    return run;
}

RawArray raw_of(const Simulation& simulation, const FloatArray& rgb, int threads)
{
    const RgbView scene = rgb_view(rgb);
    RawFrame frame;
    {
        const py::gil_scoped_release release;
        frame = simulate(scene, simulation, parallel_threads(threads));
    }
    auto* const dn = new std::vector<std::uint16_t>(std::move(frame.dn));
    const py::capsule owner(
        dn, [](void* p) { delete static_cast<std::vector<std::uint16_t>*>(p); });
    return RawArray({ frame.height, frame.width }, dn->data(), owner);
}

FloatArray signal_of(const Simulation& simulation, const FloatArray& rgb)
{
    const RgbView scene = rgb_view(rgb);
    FloatArray signal({ scene.height, scene.width });
    const Plane<float> plane { signal.mutable_data(), scene.width, scene.height,
                               scene.width };
    const py::gil_scoped_release release;
    Illegal illegal;
    simulation.block(scene, { 0, 0 }, plane, illegal);
    return signal;
}

/// Mean and variance, (height, width) each.
std::pair<FloatArray, FloatArray> expectation_of(const Simulation& simulation,
                                                 const FloatArray& rgb)
{
    const RgbView scene = rgb_view(rgb);
    FloatArray mean({ scene.height, scene.width });
    FloatArray variance({ scene.height, scene.width });
    const auto plane = [&](FloatArray& array) {
        return Plane<float> { array.mutable_data(), scene.width, scene.height,
                              scene.width };
    };
    const Plane<float> means = plane(mean), variances = plane(variance);
    const py::gil_scoped_release release;
    Illegal illegal;
    simulation.expect(scene, { 0, 0 }, means, variances, illegal);
    return { mean, variance };
}

/// (height, width, 3) camera RGB before the mosaic.
FloatArray camera_of(const SensorProfile& profile, const FloatArray& rgb,
                     const Illuminant& light, const std::string& convention,
                     double gain, bool highlights)
{
    const CameraTransform transform = camera_from_scene(
        profile, light, convention_from_name(convention), gain, highlights);
    const RgbView scene = rgb_view(rgb);
    FloatArray planes({ 3, scene.height, scene.width });
    Illegal illegal;
    for (int row = 0; row < scene.height; ++row) {
        float* const camera[3]
            = { planes.mutable_data(0, row, 0), planes.mutable_data(1, row, 0),
                planes.mutable_data(2, row, 0) };
        to_camera(transform, scene.row(row), scene.pixel_stride, scene.width, camera,
                  illegal);
    }
    return planes;
}

} // namespace

void bind_simulation(py::module_& m)
{
    py::class_<Simulation>(
        m, "Simulation", "A sensor, a light and an exposure, decided before any pixel.")
        .def(py::init([](const SensorProfile& profile, std::array<int, 2> shape,
                         const Run& run) {
                 return Simulation(profile, run, { shape[1], shape[0] });
             }),
             "profile"_a, "shape"_a, "run"_a)
        .def_property_readonly("illuminant", &Simulation::illuminant)
        .def_property_readonly("digital_gain", &Simulation::digital_gain)
        .def("raw", &raw_of, "rgb"_a, "threads"_a = 0,
             "(height, width) uint16 DN of a (height, width, 3 or 4) float32 image.")
        .def("signal", &signal_of, "rgb"_a,
             "(height, width) float32 before quantisation, 0..1 above black, not "
             "clamped.")
        .def("expectation", &expectation_of, "rgb"_a,
             "(mean, variance) of that signal, (height, width) float32 each.");
    py::class_<Run>(m, "Run", "What one exposure is asked to be.")
        .def(py::init(&run_of), "illuminant"_a, "iso"_a, "noise"_a, "seed"_a, "frame"_a,
             "digital_gain"_a, "convention"_a, "highlights"_a, "effects"_a,
             "camera_input"_a, "as_shot"_a, "sample_digital_gain"_a = false);
    m.def("to_camera", &camera_of, "profile"_a, "rgb"_a, "illuminant"_a, "convention"_a,
          "digital_gain"_a, "highlights"_a,
          "(3, height, width) float32 camera RGB before the mosaic.");
}

} // namespace cg2raw::python

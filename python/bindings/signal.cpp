// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "bindings.h"

#include "cg2raw/demosaic.h"
#include "cg2raw/parallel.h"
#include "cg2raw/signal.h"

#include <algorithm>
#include <optional>

namespace cg2raw::python {
namespace {

FloatArray mosaic_of(const py::array& rgb, const std::string& cfa, int threads)
{
    const CfaPattern pattern = cfa_from_name(cfa);
    const Scene camera(rgb);
    FloatArray raw({ camera.size().height, camera.size().width });
    const Plane<float> plane = plane_of(raw);
    const py::gil_scoped_release release;
    each_strip(camera.rows(), camera.size(), parallel_threads(threads),
               [&](const RgbView& part, int first, Illegal& illegal) {
                   std::vector<float> room(std::size_t(3) * std::size_t(part.width));
                   float* const planes[3]
                       = { room.data(), room.data() + part.width,
                           room.data() + 2 * std::ptrdiff_t(part.width) };
                   for (int row = 0; row < part.height; ++row) {
                       copy_camera(part.row(row), part.pixel_stride, part.width, 1.0f,
                                   planes, illegal);
                       mosaic(planes, pattern, { first + row, 0 }, part.width,
                              plane.row(first + row));
                   }
               });
    return raw;
}

FloatArray demosaic_of(const FloatArray& raw, const std::string& cfa, int threads)
{
    const Plane<const float> plane = const_plane_of(raw, "mosaic");
    const Demosaic demosaic(cfa_from_name(cfa), { plane.width, plane.height });
    FloatArray rgb({ plane.height, plane.width, 3 });
    float* const pixels = rgb.mutable_data();
    const py::gil_scoped_release release;
    each_strip(plane.height, parallel_threads(threads), [&](int first, int count) {
        std::vector<float> room(std::size_t(3) * std::size_t(plane.width));
        float* const planes[3] = { room.data(), room.data() + plane.width,
                                   room.data() + 2 * std::ptrdiff_t(plane.width) };
        for (int row = first; row < first + count; ++row) {
            demosaic.row(plane, row, planes);
            interleave(planes, plane.width,
                       pixels + std::ptrdiff_t(row) * plane.width * 3);
        }
    });
    return rgb;
}

/// Planes of a (height, width) mosaic or of (3, height, width) camera RGB.
std::vector<Plane<float>> planes_of(FloatArray& array)
{
    const bool camera = array.ndim() == 3;
    if ((array.ndim() != 2 && !camera) || (camera && array.shape(0) != 3)
        || array.size() == 0)
        throw Error("signal must have the shape (height, width) of a mosaic, or (3, "
                    "height, width) of camera RGB, and not be empty");
    const int height = int(array.shape(camera)), width = int(array.shape(camera + 1));
    std::vector<Plane<float>> planes;
    for (int plane = 0; plane < (camera ? 3 : 1); ++plane)
        planes.push_back(
            { array.mutable_data() + std::ptrdiff_t(plane) * height * width, width,
              height, width });
    return planes;
}

FloatArray copy_of(const FloatArray& array)
{
    return FloatArray(
        std::vector<py::ssize_t>(array.shape(), array.shape() + array.ndim()),
        array.data());
}

FloatArray with_noise(const SensorProfile& profile, const FloatArray& signal,
                      const Run& run, const std::optional<FloatArray>& out, int threads)
{
    const Plane<const float> clean = const_plane_of(signal, "signal");
    FloatArray noisy = out ? *out : FloatArray({ clean.height, clean.width });
    if (noisy.ndim() != 2 || noisy.shape(0) != clean.height
        || noisy.shape(1) != clean.width)
        throw Error("out must be an array of the shape of signal");
    const Plane<float> plane = plane_of(noisy);
    const py::gil_scoped_release release;
    const ParallelFor parallel = parallel_threads(threads);
    // A copy to new memory costs as much as the noise: its pages are touched for the
    // first time.
    if (plane.data != clean.data)
        each_strip(clean.height, parallel, [&](int first, int count) {
            for (int row = first; row < first + count; ++row)
                std::copy_n(clean.row(row), clean.width, plane.row(row));
        });
    add_noise(profile, run, plane, parallel);
    return noisy;
}

using Parameters = std::map<std::string, double>;

FloatArray with_effect(const SensorProfile& profile, const FloatArray& signal,
                       const std::string& name, const Parameters& parameters,
                       const Run& run, int threads)
{
    FloatArray result = copy_of(signal);
    const auto planes = planes_of(result);
    const py::gil_scoped_release release;
    apply_effect(profile, { name, parameters, {} }, run, planes,
                 parallel_threads(threads));
    return result;
}

std::pair<FloatArray, FloatArray> effect_expectation(const SensorProfile& profile,
                                                     const FloatArray& signal,
                                                     const std::string& name,
                                                     const Parameters& parameters,
                                                     const Run& run, int threads)
{
    FloatArray mean = copy_of(signal);
    const auto planes = planes_of(mean);
    FloatArray variance({ planes[0].height, planes[0].width });
    const Plane<float> variances = plane_of(variance);
    {
        const py::gil_scoped_release release;
        predict_effect(profile, { name, parameters, {} }, run, planes, variances,
                       parallel_threads(threads));
    }
    return { mean, variance };
}

RawArray raw_of_signal(const SensorProfile& profile, const FloatArray& signal)
{
    const Plane<const float> from = const_plane_of(signal, "signal");
    RawArray raw({ from.height, from.width });
    const Plane<std::uint16_t> to { raw.mutable_data(), from.width, from.height,
                                    from.width };
    const py::gil_scoped_release release;
    raw_from_signal(profile, from, to);
    return raw;
}

FloatArray signal_of_raw(const SensorProfile& profile, const RawArray& raw)
{
    const Plane<const std::uint16_t> from = const_plane_of(raw, "raw");
    FloatArray signal({ from.height, from.width });
    const Plane<float> to = plane_of(signal);
    const py::gil_scoped_release release;
    signal_from_raw(profile, from, to);
    return signal;
}

} // namespace

void bind_signal(py::module_& m)
{
    m.def("mosaic", &mosaic_of, "rgb"_a, "cfa"_a, "threads"_a = 0,
          "(height, width) float32: one of three values per CFA site.");
    m.def(
        "demosaic", &demosaic_of, "raw"_a, "cfa"_a, "threads"_a = 0,
        "(height, width, 3) float32: the colours that each site lacks, interpolated.");
    m.def("add_noise", &with_noise, "profile"_a, "signal"_a, "run"_a,
          py::arg("out").noconvert() = py::none(), "threads"_a = 0,
          "A clean (height, width) float32 signal with the noise of the run's ISO; in "
          "out, if that is\ngiven, which may be the signal.");
    m.def(
        "apply_effect", &with_effect, "profile"_a, "signal"_a, "name"_a, "parameters"_a,
        "run"_a, "threads"_a = 0,
        "One effect on a (height, width) mosaic, or on (3, height, width) camera RGB.");
    m.def("predict_effect", &effect_expectation, "profile"_a, "signal"_a, "name"_a,
          "parameters"_a, "run"_a, "threads"_a = 0,
          "(mean, variance) that the effect is predicted to have.");
    m.def("raw_from_signal", &raw_of_signal, "profile"_a, "signal"_a,
          "(height, width) uint16 DN of a signal in 0..1 above black.");
    m.def("signal_from_raw", &signal_of_raw, "profile"_a, "raw"_a,
          "(height, width) float32 in 0..1 above black of uint16 DN.");
}

} // namespace cg2raw::python

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "bindings.h"

#include "cg2raw/prediction.h"

namespace cg2raw::python {
namespace {

using OriginArray = py::array_t<int, py::array::c_style | py::array::forcecast>;

std::string shape_of(const py::array& array)
{
    return py::str(py::tuple(array.attr("shape")));
}

std::array<Plane<const float>, 3> planes_at(const float* pixels, Size size)
{
    const std::ptrdiff_t area = std::ptrdiff_t(size.width) * size.height;
    std::array<Plane<const float>, 3> planes;
    for (int plane = 0; plane < 3; ++plane)
        planes[std::size_t(plane)]
            = { pixels + plane * area, size.width, size.height, size.width };
    return planes;
}

GlareContext glare_context_of_frame(const FloatArray& camera)
{
    if (camera.ndim() != 3 || camera.size() == 0
        || (camera.shape(0) != 3 && camera.shape(2) != 3))
        throw Error("camera RGB must have the shape (3, height, width) or (height, "
                    "width, 3), not "
                    + shape_of(camera));
    FloatArray planes = camera;
    if (camera.shape(0) != 3)
        planes = FloatArray(camera.attr("transpose")(2, 0, 1));
    const Size size { int(planes.shape(2)), int(planes.shape(1)) };
    const auto views = planes_at(planes.data(), size);
    const py::gil_scoped_release release;
    return glare_context_of(views);
}

GlareContext scaled(GlareContext glare_context, double gain)
{
    for (std::size_t plane = 0; plane < glare_context.wide.size(); ++plane) {
        glare_context.mean[plane] *= gain;
        for (float& cell : glare_context.wide[plane])
            cell = float(gain * double(cell));
    }
    return glare_context;
}

FloatArray cells_of(const GlareContext& glare_context)
{
    const auto [width, height] = glare_context.cells;
    FloatArray cells({ 3, height, width });
    float* to = cells.mutable_data();
    for (const std::vector<float>& plane : glare_context.wide)
        to = std::copy(plane.begin(), plane.end(), to);
    return cells;
}

void check_shapes(const FloatArray& camera, const OriginArray& origins, int margin)
{
    if (camera.ndim() != 4 || camera.shape(1) != 3)
        throw Error("blocks of camera RGB must have the shape (blocks, 3, height, "
                    "width), not "
                    + shape_of(camera));
    if (origins.ndim() != 2 || origins.shape(1) != 2
        || origins.shape(0) != camera.shape(0))
        throw Error("origins must have the shape (" + std::to_string(camera.shape(0))
                    + ", 2), row and col of each block, not " + shape_of(origins));
    const py::ssize_t least = std::min(camera.shape(2), camera.shape(3));
    if (margin < 0 || 2 * py::ssize_t(margin) >= least)
        throw Error("margin " + std::to_string(margin)
                    + " must be 0 or more and leave some of the "
                    + std::to_string(least) + " pixels of a block");
}

std::tuple<FloatArray, FloatArray, FloatArray>
predicted(const SensorProfile& profile, const std::vector<NamedValues>& settings,
          const FloatArray& camera, const OriginArray& origins,
          std::array<int, 2> frame, int margin, const Vec3& neutral,
          std::optional<double> exposure_time,
          const std::optional<GlareContext>& glare_context, int threads)
{
    check_shapes(camera, origins, margin);
    const Size size { int(camera.shape(3)), int(camera.shape(2)) };
    const Size inner { size.width - 2 * margin, size.height - 2 * margin };
    const std::vector<py::ssize_t> shape { camera.shape(0), inner.height, inner.width };
    std::array<FloatArray, 3> results { FloatArray(shape), FloatArray(shape),
                                        FloatArray(shape) };
    std::vector<PredictedBlock> blocks;
    for (py::ssize_t i = 0; i < camera.shape(0); ++i) {
        const auto result = [&](std::size_t which) {
            return Plane<float> { results[which].mutable_data(i), inner.width,
                                  inner.height, inner.width };
        };
        blocks.push_back({ { origins.at(i, 0), origins.at(i, 1) },
                           inner,
                           planes_at(camera.data(i), size),
                           result(0),
                           result(1),
                           result(2) });
    }
    const Exposure exposure { { frame[1], frame[0] },
                              profile.cfa,
                              neutral,
                              exposure_time,
                              glare_context ? &*glare_context : nullptr };
    {
        const py::gil_scoped_release release;
        predict_blocks(profile, settings, exposure, blocks, margin,
                       parallel_threads(threads));
    }
    return { results[0], results[1], results[2] };
}

} // namespace

void bind_prediction(py::module_& m)
{
    py::class_<GlareContext>(m, "GlareContext", "A frame of camera RGB in few cells.")
        .def_readonly("mean", &GlareContext::mean, "(3,) of the frame.")
        .def_property_readonly(
            "wide", &cells_of,
            "(3, rows, cols) float32, spread over a sixth of the height.")
        .def("scaled", &scaled, "gain"_a, "That of a frame so many times as bright.");
    m.def("glare_context", &glare_context_of_frame, "camera"_a,
          "GlareContext of a whole frame of camera RGB, (3, height, width) or (height, "
          "width, 3)\nfloat32.");
    m.def(
        "predict_blocks", &predicted, "profile"_a, "settings"_a, "camera"_a,
        "origins"_a, "frame"_a, "margin"_a, "neutral"_a, "exposure_time"_a.none(),
        "glare_context"_a.none(), "threads"_a = 1,
        "(mean, variance, exposed) of blocks of a frame, each (blocks, height - 2 "
        "margin, width -\n2 margin) float32 in 0..1 above black and beyond, as a "
        "physical sensor has them: nothing is\nclipped that no effect clips.\n\n"
        "settings : name and values, in the order of the registry's parameters, of "
        "every effect; those\n    of the profile are not added.\n"
        "camera : (blocks, 3, height, width) float32 camera RGB that enters the "
        "lens, margin included; moved into\n    the frame where that would leave it.\n"
        "origins : (blocks, 2) row and col of the first predicted pixel of each block "
        "in the active area.\n"
        "frame : (height, width) of the active area.\n"
        "margin : pixels, at least what the effects reach together, but where the "
        "frame ends.\n"
        "neutral : (3,) camera RGB of white, largest 1.\n"
        "exposure_time : seconds, where an effect needs it.\n"
        "glare_context : of the whole frame, where an effect needs it.");
}

} // namespace cg2raw::python

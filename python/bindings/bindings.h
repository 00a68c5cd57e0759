// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What the parts of the module share: array types and the parts themselves.
#pragma once

#include "cg2raw/dng_writer.h"
#include "cg2raw/frame.h"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

namespace cg2raw::python {

namespace py = pybind11;
using namespace pybind11::literals;

using FloatArray = py::array_t<float, py::array::c_style | py::array::forcecast>;
using RawArray = py::array_t<std::uint16_t, py::array::c_style>;

/// (3, 3) float64 array of a matrix.
inline py::array_t<double> array_of(const Mat3& matrix)
{
    return py::array_t<double>({ 3, 3 }, matrix.m.data());
}

/// A spectrum in Python: wavelengths in nm and values.
using Rows = std::vector<std::pair<double, double>>;
Rows rows_of(const Spectrum& spectrum);

/// What has a text, or None.
template <class T>
std::optional<std::string> text_or_none(const std::optional<T>& value)
{
    return value ? std::optional(text_of(*value)) : std::nullopt;
}

/// A (height, width, 3 or 4) image argument. float32 whose channels lie together is
/// seen in place, with any strides of its rows and columns; float16 is converted strip
/// by strip; other float32 layouts are copied. Throws Error on other shapes and types.
class Scene {
public:
    explicit Scene(const py::array& rgb);

    Size size() const { return { m_view.width, m_view.height }; }
    /// Valid while this object is; needs no GIL.
    SceneRows rows() const;

private:
    py::array m_owner;
    RgbView m_view; ///< its data is null if the pixels are half floats
    const std::uint16_t* m_half = nullptr;
};

/// View of a (height, width) array of float. Throws Error on another shape.
inline Plane<float> plane_of(FloatArray& array)
{
    return { array.mutable_data(), int(array.shape(1)), int(array.shape(0)),
             array.shape(1) };
}

/// Plane of a (height, width) argument; @p what names it. Throws Error.
template <class T, int flags>
Plane<const T> const_plane_of(const py::array_t<T, flags>& array, const char* what)
{
    if (array.ndim() != 2 || array.size() == 0)
        throw Error(std::string(what)
                    + " must be an array of shape (height, width), not empty");
    return { array.data(), int(array.shape(1)), int(array.shape(0)), array.shape(1) };
}

/// Three planes of a row -> interleaved pixels.
inline void interleave(const float* const planes[3], int width, float* rgb)
{
    for (int col = 0; col < width; ++col)
        for (int color = 0; color < 3; ++color)
            rgb[3 * col + color] = planes[color][col];
}

/// Writes the DNG of a simulation's frame. @p drawn: the simulation made its DN.
void write_frame(const std::string& path, const RawArray& raw,
                 const Simulation& simulation, const DngOptions& options,
                 const Shot& shot, int threads, bool drawn);

void bind_color(py::module_& m);
void bind_profile(py::module_& m);
void bind_scene_file(py::module_& m);
void bind_encoding(py::module_& m);
void bind_spectral_image(py::module_& m);
void bind_transform(py::module_& m);
void bind_simulation(py::module_& m);
void bind_signal(py::module_& m);
void bind_prediction(py::module_& m);
void bind_frame_statistics(py::module_& m);
void bind_dng(py::module_& m);
void bind_shot(py::module_& m);
void bind_export(py::module_& m);
void bind_file(py::module_& m);

} // namespace cg2raw::python

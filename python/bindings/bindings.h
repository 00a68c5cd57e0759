// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What the parts of the module share: array types and the parts themselves.
#pragma once

#include "cg2raw/dng_reader.h"

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

/// View of a (height, width, 3 or 4) array. Throws Error on another shape.
inline RgbView rgb_view(const FloatArray& rgb)
{
    if (rgb.ndim() != 3 || rgb.shape(2) < 3 || rgb.shape(2) > 4)
        throw Error(
            "image must be an array of shape (height, width, 3) or (height, width, "
            "4), RGB(A)");
    const int width = int(rgb.shape(1)), height = int(rgb.shape(0));
    const auto channels = std::ptrdiff_t(rgb.shape(2));
    return { rgb.data(), width, height, channels, channels * width };
}

void bind_color(py::module_& m);
void bind_profile(py::module_& m);
void bind_transform(py::module_& m);
void bind_simulation(py::module_& m);
void bind_dng(py::module_& m);

} // namespace cg2raw::python

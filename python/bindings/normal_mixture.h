// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file A law that is a sum of normals, and the pieces by which many values of it are
/// gone through.
#pragma once

#include "bindings.h"

#include <algorithm>

namespace cg2raw::python {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

constexpr int piece = 512; ///< values, with all sums about them, stay in a cache
constexpr double least_exponent = -700.0; ///< whose exponential is no denormal number

/// A sum of normals.
struct Mixture {
    const double *weights, *means, *variances;
    int parts;
};

/// Of an array of three rows; throws Error for another.
inline Mixture mixture_of(const Numbers& law)
{
    if (law.ndim() != 2 || law.shape(0) != 3)
        throw Error("the law must be an array of three rows");
    return { law.data(0, 0), law.data(1, 0), law.data(2, 0), int(law.shape(1)) };
}

/// Call work(first, count) for pieces of all values; without the GIL.
template <class Work> void each_piece(py::ssize_t size, const Work& work)
{
    const py::gil_scoped_release release;
    for (py::ssize_t first = 0; first < size; first += piece)
        work(first, int(std::min<py::ssize_t>(piece, size - first)));
}

} // namespace cg2raw::python

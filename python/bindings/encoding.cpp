// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/encoding.h"

#include "bindings.h"

namespace cg2raw::python {
namespace {

/// (height, width, 3) light of (height, width, 3 or 4) numbers of a file.
FloatArray decoded(const Decoder& decoder, const FloatArray& pixels)
{
    const py::ssize_t least = decoder.needs_alpha() ? 4 : 3;
    if (pixels.ndim() != 3 || pixels.shape(2) < least || pixels.shape(2) > 4)
        throw Error("pixels must be (height, width, " + std::to_string(least)
                    + "): R, G, B" + (least == 4 ? " and alpha" : ""));
    const py::ssize_t height = pixels.shape(0), width = pixels.shape(1),
                      depth = pixels.shape(2);
    FloatArray light({ height, width, py::ssize_t(3) });
    const float* from = pixels.data();
    float* to = light.mutable_data();
    const py::gil_scoped_release release;
    for (py::ssize_t row = 0; row < height; ++row, from += depth * width) {
        for (py::ssize_t col = 0; col < width; ++col)
            std::copy_n(from + depth * col, 3, to + 3 * col);
        decoder.decode(to, from + depth - 1, depth, int(width));
        to += 3 * width;
    }
    return light;
}

} // namespace

void bind_encoding(py::module_& m)
{
    py::class_<Decoder>(m, "Decoder", "Numbers of a file -> light over black.")
        .def_property_readonly("is_identity", &Decoder::is_identity)
        .def_property_readonly("needs_alpha", &Decoder::needs_alpha)
        .def("decode", &decoded, "pixels"_a,
             "(H, W, 3) float32 light of (H, W, 3 or 4) numbers; alpha comes last.");
    m.def("levels_of", &levels_of, "samples"_a,
          "Code values of whole numbers: 256, 65536; 0 of floats, -1 of others.");
}

} // namespace cg2raw::python

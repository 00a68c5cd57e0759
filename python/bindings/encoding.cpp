// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/encoding.h"

#include "bindings.h"
#include "constructor.h"

namespace cg2raw::python {
namespace {

Alpha alpha_from_name(const std::string& name)
{
    if (name == "associated" || name == "unassociated")
        return name == "associated" ? Alpha::associated : Alpha::unassociated;
    if (name != "none")
        throw Error("alpha \"" + name + "\" must be none, associated or unassociated");
    return Alpha::none;
}

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

StatedEncoding stated(std::string space, bool is_rec709, bool is_raw,
                      std::string samples, std::string icc_profile,
                      std::string transfer, double gamma)
{
    return { std::move(space),       is_rec709,           is_raw, std::move(samples),
             std::move(icc_profile), std::move(transfer), gamma };
}

} // namespace

void bind_encoding(py::module_& m)
{
    py::class_<StatedEncoding> said(m, "StatedEncoding",
                                    "What a file, or its user, says of its encoding.");
    def_constructor(said, &stated, "space"_a, "is_rec709"_a, "is_raw"_a, "samples"_a,
                    "icc_profile"_a = "", "transfer"_a = "", "gamma"_a = 0.0);
    said.def_readonly("space", &StatedEncoding::space);
    py::class_<Curve>(m, "Curve", "From light to the numbers of a file.")
        .def_property_readonly("name", &Curve::name, "srgb, g2.2, or nothing.");
    m.def(
        "curve_of",
        [](const StatedEncoding& encoding, const std::string& undo,
           const std::string& linearize, const std::string& is_linear,
           const std::string& convert) {
            return curve_of(encoding, undo_from_name(undo),
                            { linearize, is_linear, [&] { return convert; } });
        },
        "said"_a, "undo"_a, "linearize"_a, "is_linear"_a, "convert"_a,
        "Return the Curve to undo: none, srgb, stated or stated-or-srgb; the others "
        "are\nremedies, for messages. Raises Error.");
    py::class_<Decoder> decoder(m, "Decoder", "Numbers of a file -> light over black.");
    def_constructor(
        decoder,
        +[](const std::optional<Curve>& curve, const std::string& alpha, int levels) {
            return Decoder(curve.value_or(Curve {}), alpha_from_name(alpha), levels);
        },
        "curve"_a, "alpha"_a, "levels"_a);
    decoder.def_property_readonly("is_identity", &Decoder::is_identity)
        .def_property_readonly("needs_alpha", &Decoder::needs_alpha)
        .def("decode", &decoded, "pixels"_a,
             "(H, W, 3) float32 light of (H, W, 3 or 4) numbers; alpha comes last.");
    m.def("levels_of", &levels_of, "samples"_a,
          "Code values of whole numbers: 256, 65536; 0 of floats, -1 of others.");
}

} // namespace cg2raw::python

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "bindings.h"
#include "constructor.h"

#include "cg2raw/random.h"

namespace cg2raw::python {
namespace {

RobertsonTable table_from_name(const std::string& name)
{
    if (name == "adobe")
        return RobertsonTable::adobe;
    if (name == "corrected")
        return RobertsonTable::corrected;
    throw Error("table \"" + name + "\" must be adobe or corrected");
}

} // namespace

void bind_color(py::module_& m)
{
    m.def(
        "temperature_from_xy",
        [](std::array<double, 2> xy, const std::string& table) {
            const Temperature t
                = temperature_from_xy({ xy[0], xy[1] }, table_from_name(table));
            return std::array<double, 2> { t.cct.value, t.duv };
        },
        "xy"_a, "table"_a = "adobe",
        "(CCT in K, Duv) of a CIE 1931 chromaticity, by Robertson's isotherms.\n\n"
        "table : \"adobe\" for parity with raw converters, or \"corrected\".");
    m.def(
        "planckian_xy",
        [](double cct) {
            const Chromaticity xy = planckian_xy({ cct });
            return std::array<double, 2> { xy.x, xy.y };
        },
        "cct"_a,
        "CIE 1931 (x, y) of the black body at cct, 1667 to 25000 K.\n\n"
        "Raises ValueError outside that range.");
    m.def(
        "xyz_d65_from_srgb", [] { return array_of(xyz_d65_from_srgb()); },
        "(3, 3) float64: XYZ with D65 white from linear sRGB. Source: IEC 61966-2-1.");
    m.def(
        "xyz_d50_from_srgb", [] { return array_of(xyz_d50_from_srgb()); },
        "(3, 3) float64: the same, adapted to D50 by Bradford.");
    m.def("is_rec709_name", &is_rec709_name, "space"_a,
          "Whether a colour space's name is known to mean scene-linear Rec.709.");
    py::class_<Rng> rng(m, "Rng",
                        "Random numbers that are pure functions of (seed, purpose, "
                        "frame) and n.");
    def_constructor(
        rng,
        +[](std::uint64_t seed, std::string_view purpose, std::int64_t frame) {
            return Rng(seed, purpose, frame);
        },
        "seed"_a, "purpose"_a, "frame"_a = 0);
    rng.def("uniform", &Rng::uniform, "n"_a,
            "The n-th uniform in (0, 1), float64; n from 0 to 2**32 - 1.")
        .def("normal", &Rng::normal, "n"_a,
             "The n-th standard normal, float64; uses uniforms 2n and 2n + 1.");
    m.def(
        "philox_words", &philox_words, "counter"_a, "key"_a,
        "Philox 4x32-10: four 32-bit words of a counter (4 words) under a key (2).\n\n"
        "Source: Salmon et al., SC 2011.");
}

} // namespace cg2raw::python

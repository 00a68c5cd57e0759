// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What the fields of a profile are in Python.
#pragma once

#include "bindings.h"

#include "cg2raw/effect.h"

#include <optional>
#include <type_traits>
#include <vector>

namespace cg2raw::python {

/// What pybind11 converts is left to it.
template <class T> const T& to_python(const T& value) { return value; }
inline std::string to_python(const CfaPattern& cfa) { return name_of(cfa); }
py::dict to_python(const NoiseAtIso& noise);
py::dict to_python(const Calibration& calibration);
py::dict to_python(const SpectralSensitivities& sensitivities);
py::dict to_python(const NeutralDistribution& lights);
py::dict to_python(const Lamp& lamp);
py::dict to_python(const DigitalGain& gain);
py::dict to_python(const EffectSetting& setting);
/// Those of most profiles, where it names none.
std::vector<std::string> to_python(const std::optional<NoiseEffects>& effects);

template <class T> py::object to_python(const std::optional<T>& value)
{
    if (!value)
        return py::none();
    if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>)
        return py::cast(*value);
    else
        return to_python(*value);
}
inline const std::vector<double>& to_python(const std::vector<double>& values)
{
    return values;
}
inline const TextsByField& to_python(const TextsByField& texts) { return texts; }
template <class T> py::list to_python(const std::vector<T>& values)
{
    py::list list;
    for (const T& value : values)
        list.append(to_python(value));
    return list;
}

/// The parameters that an effect has for one CFA, or for all.
py::dict dict_of(const Effect& effect, const std::vector<Parameter>& of_cfa);

/// A type in the words of a stub, and what its docstring says of its parts.
struct PythonType {
    const char* word;
    const char* parts = "";
};
template <class T> constexpr PythonType python_type {};
template <> inline constexpr PythonType python_type<int> { "int" };
template <> inline constexpr PythonType python_type<std::string> { "str" };
template <> inline constexpr PythonType python_type<CfaPattern> { "str" };
template <>
inline constexpr PythonType python_type<std::optional<double>> { "float | None" };
template <>
inline constexpr PythonType python_type<std::vector<double>> { "list[float]" };
template <>
inline constexpr PythonType python_type<TextsByField> { "list[tuple[str, str]]",
                                                        "\n\n(field, text) each." };
template <>
inline constexpr PythonType python_type<std::vector<Calibration>> {
    "list[dict[str, Any]]",
    "\n\n{\"light_source\", \"camera_from_xyz\", \"xyz_d50_from_camera\"} each: name "
    "of the light,\n(3, 3) ColorMatrix, (3, 3) ForwardMatrix or None."
};
template <>
inline constexpr PythonType python_type<std::vector<Lamp>> {
    "list[dict[str, Any]]",
    "\n\n{\"name\", \"light_source\", \"neutral\", \"has_power\", "
    "\"camera_from_xyz\"} each: its illuminant\nword, EXIF name or \"other\", (R/G, "
    "B/G), whether its spectrum is known, (3, 3) ColorMatrix."
};
template <>
inline constexpr PythonType python_type<std::optional<SpectralSensitivities>> {
    "dict[str, Any] | None",
    "\n\n{\"wavelengths\", \"rgb\", \"unit\", \"scale\"}, or None: (n,) nm, rising; "
    "(n, 3), alike in all\ncolumns if monochrome."
};
template <>
inline constexpr PythonType python_type<NeutralDistribution> {
    "dict[str, Any]",
    "\n\n{\"neutrals\", \"mean\", \"covariance\", \"hull\", \"mixture\"} in (R/G, "
    "B/G): as measured, may be\nempty; (2, 2), divisor N - 1; counter-clockwise, empty "
    "if fewer than 3 neutrals are\ndistinct; {\"weight\", \"mean\", \"covariance\"} "
    "each."
};
template <>
inline constexpr PythonType python_type<std::optional<DigitalGain>> {
    "dict[str, float] | None", "\n\n{\"mean\", \"sigma\"}, or None."
};
template <>
inline constexpr PythonType python_type<std::vector<NoiseAtIso>> {
    "list[dict[str, Any]]",
    "\n\n{\"iso\", \"beta1\", \"beta2\"} each, beta1 and beta2 per CFA site; empty: "
    "not "
    "measured."
};
template <>
inline constexpr PythonType python_type<std::optional<NoiseEffects>> { "list[str]" };
template <>
inline constexpr PythonType python_type<std::vector<EffectSetting>> {
    "list[dict[str, Any]]",
    "\n\n{\"name\", \"parameters\", \"evidence\"} each, in order."
};

} // namespace cg2raw::python

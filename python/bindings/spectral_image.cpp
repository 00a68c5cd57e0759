// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/spectral_image.h"

#include "bindings.h"
#include "cg2raw/parallel.h"
#include "constructor.h"

#include <numeric>

namespace cg2raw::python {
namespace {

using Light = std::variant<Illuminant, Rows>;
/// Centres of boxes in nm, or the bins of an image.
using Bins = std::variant<SpectralChannels, std::vector<double>>;

/// Of pixels that hold the bins alone, in their order.
SpectralResponse response_of(const SensorProfile& profile, const Light& light,
                             const Bins& bins, double white)
{
    SpectralChannels found;
    if (const auto* const channels = std::get_if<SpectralChannels>(&bins))
        found = *channels;
    else
        found.wavelengths = std::get<std::vector<double>>(bins);
    if (found.wavelengths.size() < 2)
        throw Error("a spectrum has two or more bins");
    found.channels.resize(found.wavelengths.size());
    std::iota(found.channels.begin(), found.channels.end(), 0);
    const auto* const rows = std::get_if<Rows>(&light);
    const Spectrum power = rows
        ? spectrum_from_rows(*rows)
        : spectrum_of(profile, std::get<Illuminant>(light)).power;
    return { profile, power, found, white };
}

/// (height, width, 3) of (height, width, bins).
FloatArray camera_of(const SpectralResponse& response, const FloatArray& spectra,
                     int threads)
{
    const auto bins = py::ssize_t(response.per_bin().size());
    if (spectra.ndim() != 3 || spectra.shape(2) != bins)
        throw Error("spectra must be an array of shape (height, width, "
                    + std::to_string(bins) + "), a bin per wavelength");
    const py::ssize_t height = spectra.shape(0), width = spectra.shape(1);
    FloatArray out({ height, width, py::ssize_t(3) });
    const float* const from = spectra.data();
    float* const to = out.mutable_data();
    const py::gil_scoped_release release;
    each_strip(int(height), parallel_threads(threads), [&](int first, int count) {
        for (py::ssize_t row = first; row < first + count; ++row)
            response.to_camera(from + row * width * bins, bins, int(width),
                               to + row * width * 3);
    });
    return out;
}

/// (bins, n) of n numbers a bin.
template <std::size_t n>
py::array_t<double> array_of(const std::vector<std::array<double, n>>& bins)
{
    return py::array_t<double>({ py::ssize_t(bins.size()), py::ssize_t(n) },
                               bins.front().data());
}

} // namespace

Rows rows_of(const Spectrum& spectrum)
{
    Rows rows;
    for (std::size_t i = 0; i < spectrum.values.size(); ++i)
        rows.emplace_back(spectrum.wavelengths[i], spectrum.values[i]);
    return rows;
}

void bind_spectral_image(py::module_& m)
{
    py::class_<SpectralChannels>(m, "SpectralChannels")
        .def_readonly("channels", &SpectralChannels::channels,
                      "Indices of the image's channels, by rising wavelength.")
        .def_readonly("wavelengths", &SpectralChannels::wavelengths,
                      "Centres of their bins, nm.");
    py::class_<SpectralResponse> response(m, "SpectralResponse",
                                          "Camera RGB (white 1) of spectral radiance.");
    def_constructor(
        response, &response_of, "profile"_a, "light"_a, "bins"_a, "white"_a,
        "light : Illuminant, or [(nm, power)]. bins : centres of boxes, (n,) nm, "
        "or\nSpectralChannels. white : cd/m2.");
    response
        .def_property_readonly(
            "per_bin", [](const SpectralResponse& r) { return array_of(r.per_bin()); },
            "(n, 3): camera RGB of 1 W/(m2 sr nm) in each bin.")
        .def_property_readonly(
            "widths", [](const SpectralResponse& r) { return array_of(r.widths()); },
            "(n, 2): nm that a bin stands for, and how many of them the sensitivities "
            "reach.")
        .def("to_camera", &camera_of, "spectra"_a, "threads"_a = 0,
             "(H, W, 3) float32 camera RGB of (H, W, n) spectra.");
    m.def("seen_by_sensitivities", &seen_by_sensitivities, "profile"_a, "spec"_a,
          "The word of an illuminant whose neutral is the one that the sensitivities "
          "see.");
    m.def(
        "neutral_word",
        [](const SensorProfile& profile, const Rows& power) {
            return neutral_word(profile, spectrum_from_rows(power));
        },
        "profile"_a, "power"_a,
        "The word neutral: of a light, [(nm, power)], as the sensitivities see it.");
    m.def(
        "spectrum_from_text",
        [](const std::string& text) { return rows_of(spectrum_from_text(text)); },
        "text"_a,
        "[(nm, value)] of \"550nm:0.3;560nm:0.4;\", as spectral images state lights. "
        "Raises\nValueError.");
}

} // namespace cg2raw::python

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/spectral_image.h"

#include "bindings.h"
#include "cg2raw/parallel.h"

#include <numeric>

namespace cg2raw::python {
namespace {

SpectralResponse response_of(const SensorProfile& profile, const Illuminant& light,
                             const std::vector<double>& wavelengths, double white)
{
    SpectralChannels bins { std::vector<int>(wavelengths.size()), wavelengths };
    std::iota(bins.channels.begin(), bins.channels.end(), 0);
    return { profile, light, bins, white };
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

py::array_t<double> per_bin(const SpectralResponse& response)
{
    const auto& bins = response.per_bin();
    return py::array_t<double>({ py::ssize_t(bins.size()), py::ssize_t(3) },
                               bins.front().data());
}

} // namespace

void bind_spectral_image(py::module_& m)
{
    py::class_<SpectralChannels>(m, "SpectralChannels")
        .def_readonly("channels", &SpectralChannels::channels,
                      "Indices of the image's channels, by rising wavelength.")
        .def_readonly("wavelengths", &SpectralChannels::wavelengths,
                      "Centres of their bins, nm.");
    m.def(
        "spectral_channels",
        [](const std::vector<std::string>& names,
           const std::map<std::string, double>& stated) {
            return spectral_channels(
                names, [&](const std::string& name) -> std::optional<double> {
                    const auto found = stated.find(name);
                    return found == stated.end() ? std::nullopt
                                                 : std::optional(found->second);
                });
        },
        "names"_a, "stated"_a = std::map<std::string, double> {},
        "The SpectralChannels among an image's channels (\"S0.550,0nm\"), or None.\n\n"
        "stated : {channel: wavelength in m}, as files of Ocean say it in "
        "attributes.\nRaises ValueError.");
    py::class_<SpectralResponse>(m, "SpectralResponse",
                                 "Camera RGB (white 1) of spectral radiance.")
        .def(py::init(&response_of), "profile"_a, "illuminant"_a, "wavelengths"_a,
             "white"_a)
        .def_property_readonly("per_bin", &per_bin,
                               "(n, 3): camera RGB of 1 W/(m2 sr nm) in each bin.")
        .def("to_camera", &camera_of, "spectra"_a, "threads"_a = 0,
             "(H, W, 3) float32 camera RGB of (H, W, n) spectra.");
    m.def("seen_by_sensitivities", &seen_by_sensitivities, "profile"_a, "spec"_a,
          "The word of an illuminant whose neutral is the one that the sensitivities "
          "see.");
}

} // namespace cg2raw::python

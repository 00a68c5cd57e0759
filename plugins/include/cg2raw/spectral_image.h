// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Images whose channels are the bins of a spectrum, and what a sensor sees of
/// them.
#pragma once

#include "cg2raw/illuminant.h"

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace cg2raw {

/// Channels that together are the spectral radiance of each pixel.
struct SpectralChannels {
    std::vector<int> channels; ///< of the image, by rising wavelength
    std::vector<double> wavelengths; ///< centres of their bins, nm
    std::vector<Spectrum> responses {}; ///< of the channels; empty: bins are boxes
};

/// What an attribute says of a channel: its wavelength in m, its response as a text.
using StatedWavelength = std::function<std::optional<double>(const std::string&)>;
using StatedResponse = std::function<std::optional<std::string>(const std::string&)>;

/// The bins among the channels of an image; nothing if it has none.
///
/// Names are those of Fichet, Pacanowski and Wilkie: "S0.550,0nm", "S0.5,5e-7m",
/// "S0.545THz"; other Stokes components (S1 to S3) are left out. @p stated gives a
/// channel's wavelength where the file says it in an attribute "<channel>.wavelength",
/// as Ocean's do; @p response the text of an attribute of a channel's own name, which
/// is what the layout states a channel's response by. Throws Error for reflectances
/// ("T.550nm") without a radiance, for one bin alone, for two of one wavelength, and
/// for a response that some channels lack.
/// Sources: Fichet et al., An OpenEXR Layout for Spectral Images, JCGT 10(3), 2021;
/// Eclat Digital, Ocean 2019, "Spectral EXR format".
std::optional<SpectralChannels> spectral_channels(const std::vector<std::string>& names,
                                                  const StatedWavelength& stated,
                                                  const StatedResponse& response = {});

/// Camera RGB (white 1) of spectral radiance, decided before the first pixel.
class SpectralResponse {
public:
    /// Each bin is a box that reaches half way to its neighbours, over which the
    /// sensitivities are integrated exactly. Bins that state their responses share out
    /// the wavelengths by them: radiance is the mean of the bins, weighted by their
    /// responses. @p white is the luminance in cd/m2 of a perfect diffuser under
    /// @p light that saturates the sensor's most sensitive channel; radiance is in
    /// W/(m2 sr nm). Throws Error for a sensor without sensitivities, bins that it does
    /// not see, and a luminance that is not above 0.
    SpectralResponse(const SensorProfile& profile, const Spectrum& light,
                     const SpectralChannels& bins, double white);

    /// One row: @p pixels steps by @p pixel_stride floats, and holds all channels of
    /// the image; @p rgb gets 3 floats a pixel.
    void to_camera(const float* pixels, std::ptrdiff_t pixel_stride, int width,
                   float* rgb) const;

    /// The same of pixels that hold the bins alone.
    SpectralResponse of_bins_alone() const;

    /// Per bin: what camera R, G, B get of a radiance of 1 W/(m2 sr nm).
    const std::vector<Vec3>& per_bin() const { return m_per_bin; }
    /// Per bin: how many nm it stands for, and how many of them the sensor's
    /// sensitivities reach.
    const std::vector<std::array<double, 2>>& widths() const { return m_widths; }

private:
    std::vector<int> m_channels;
    std::vector<Vec3> m_per_bin;
    std::vector<std::array<double, 2>> m_widths;
    std::vector<std::array<float, 4>> m_weights; ///< R, G, B, 0
};

/// The illuminant that @p spec names with its neutral as the sensitivities see its
/// spectrum: what a white object is in a spectral image. That of a word which is a
/// neutral itself (neutral:, xy:, sample:, as-shot) stays. Throws Error.
std::string seen_by_sensitivities(const SensorProfile& profile,
                                  const std::string& spec);
/// The word neutral: of a light whose spectrum is known. Throws Error for a sensor
/// without sensitivities, and one that does not see the light.
std::string neutral_word(const SensorProfile& profile, const Spectrum& light);

} // namespace cg2raw

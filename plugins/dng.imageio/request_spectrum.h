// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What an image asks for whose channels are a spectrum.
#pragma once

#include "attributes.h"
#include "request.h"

namespace cg2raw {

/// The bins of a spectrum among the channels, unless a layer is asked for.
std::optional<SpectralChannels> bins_of(const OIIO::ImageSpec& spec,
                                        const Attributes& attributes);

/// Makes pixels the light that the sensor's channels see, and white what its
/// sensitivities make of the light that is asked for; "estimate" is the one that the
/// file states. Throws Error for what has no meaning for spectra, and for a sensor
/// without sensitivities.
void put_spectrum(const OIIO::ImageSpec& spec, const Attributes& attributes,
                  const SpectralChannels& bins, Request& request);

/// Throws Error if @p illuminant is to be estimated, which only spectra are good for.
void refuse_estimate(const std::string& illuminant);

} // namespace cg2raw

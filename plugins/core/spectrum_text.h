// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Wavelengths as spectral images write them, in names and in attributes.
#pragma once

#include <optional>
#include <string_view>

namespace cg2raw {

/// Wavelengths that channels may have, nm.
constexpr double shortest_of_channels = 1.0, longest_of_channels = 1e6;

/// nm of "550,0nm", "5,5e-7m" or "545THz" with @p decimal for the comma; nothing for
/// other words, and for wavelengths that no channel has.
std::optional<double> wavelength_of(std::string_view word, char decimal);

} // namespace cg2raw

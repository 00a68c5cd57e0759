// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Spectra of lamps by name, and where tables have them; private to the core.
#pragma once

#include "cg2raw/illuminant.h"

namespace cg2raw {

/// Of all tables of spectra in the core: 380 to 780 nm by 5.
std::vector<double> table_wavelengths();
/// The CIE's lamp of this name (FL2, LED-B3, HP1 ...), '_' and '.' as good as '-'.
std::optional<LightSpectrum> lamp_spectrum(const std::string& name);

} // namespace cg2raw

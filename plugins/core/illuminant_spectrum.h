// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Spectra of lamps by name; private to the core.
#pragma once

#include "cg2raw/illuminant.h"

namespace cg2raw {

/// The CIE's lamp of this name (FL2, LED-B3, HP1 ...), '_' and '.' as good as '-'.
std::optional<LightSpectrum> lamp_spectrum(const std::string& name);

} // namespace cg2raw

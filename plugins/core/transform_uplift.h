// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Reflectances of scene-linear Rec.709, and what a sensor sees of them; private
/// to the core.
///
/// A reflectance is a sum of seven spectra, whose weights are the terms of a
/// root-polynomial: r, g, b, sqrt(rg), sqrt(gb), sqrt(rb), and one of grey,
/// m (rgb / m^3)^8 with m = (r + g + b) / 3, that is near 0 for all that is not nearly
/// grey. Roots and the term of grey take negative components for 0. All grow with the
/// exposure. White is a reflectance of 1 at all wavelengths.
/// Source: G. Finlayson, M. Mackiewicz, A. Hurlbert, Color Correction Using
/// Root-Polynomial Regression, IEEE Trans. Image Processing 24(5), 2015; for spectra,
/// and with white exact, scripts/spectra_tables.py.
#pragma once

#include "cg2raw/transform.h"

namespace cg2raw {

/// Balanced camera RGB (white 1, 1, 1) from the terms of scene-linear Rec.709, as the
/// sensitivities see the reflectances under @p light.
UpliftMatrix balanced_from_terms(const SpectralSensitivities& sensitivities,
                                 const Spectrum& light);

} // namespace cg2raw

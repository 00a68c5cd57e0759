// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The field spectral_sensitivities of a profile's JSON; private to the core.
#pragma once

#include "profile_json_fields.h"

namespace cg2raw {

/// Channels R, G and B; of a monochrome sensor the one that is called mono.
SpectralSensitivities sensitivities_from_json(Fields fields, const CfaPattern& cfa);
JsonTree json_of(const SpectralSensitivities& sensitivities, const CfaPattern& cfa);

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What a profile may say of its neutrals; private to the core.
#pragma once

#include "cg2raw/profile.h"

#include <string>

namespace cg2raw {

/// Of a mixture.
constexpr int most_neutral_gaussians = 16;

/// Throws Error, led by @p file, for neutrals, or a distribution of them, that no draw
/// can be made of.
void check_neutrals(const SensorProfile& profile, const std::string& file);

} // namespace cg2raw

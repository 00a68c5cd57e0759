// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What a profile may say of its lamps; private to the core.
#pragma once

#include "cg2raw/profile.h"

namespace cg2raw {

/// Of a spectrum, relative.
constexpr double most_lamp_power = 1e9;

/// Throws Error, led by @p file, for a name that is no word, or that two lamps have,
/// or a power that is no light.
void check_lamps(const std::vector<Lamp>& lamps, const std::string& file);

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The noise table of a profile: its bounds, and noise between calibrated ISOs.
#pragma once

#include "cg2raw/profile.h"

namespace cg2raw {

/// Of a profile's noise; no camera has more.
constexpr double most_noise_iso = 1e7;

/// Throws Error if the profile's noise, or what is to draw it, is not within its
/// bounds; @p file leads the message.
void check_noise(const SensorProfile& profile, const std::string& file);

} // namespace cg2raw

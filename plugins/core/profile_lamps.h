// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The field lamps of a profile's JSON; private to the core.
#pragma once

#include "profile_json_fields.h"

namespace cg2raw {

std::vector<Lamp> lamps_from_json(std::vector<Fields> rows);
JsonTree json_of(const Lamp& lamp);

/// Throws Error, led by @p file, for a name that is no word, or that two lamps have,
/// or a power that is no light.
void check_lamps(const std::vector<Lamp>& lamps, const std::string& file);

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What a profile's fields are; private to the core.
#pragma once

#include "cg2raw/profile.h"
#include "profile_json_tree.h"

namespace cg2raw {

/// The JSON Schema of profiles. @p effects : that of one effect.
JsonTree profile_schema(JsonTree effects);

/// Throws Error, led by @p file, for a field that is not what its rule says.
void check_fields(const SensorProfile& profile, const std::string& file);

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Names that effects had, and have now; profiles hold them.
#pragma once

#include <string_view>

namespace cg2raw {

/// Throws Error that says the new name, for an effect that was renamed.
void check_effect_name(std::string_view name);

} // namespace cg2raw

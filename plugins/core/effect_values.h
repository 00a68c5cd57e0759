// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What values of an effect must be; private to what puts effects into a run.
#pragma once

#include "cg2raw/effect.h"

namespace cg2raw {

/// Throws Error unless @p values are one per parameter that @p effect has on @p cfa,
/// each within its bounds; @p file leads the message.
void check_values(const Effect& effect, const Values& values, const CfaPattern& cfa,
                  const std::string& file);

} // namespace cg2raw

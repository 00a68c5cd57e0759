// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What values of an effect must be; private to what puts effects into a run.
#pragma once

#include "cg2raw/effect.h"

namespace cg2raw {

/// One value per parameter that @p effect has on @p cfa: @p values, and null for
/// optional parameters at the end that they do without. Throws Error if others are
/// missing, or one is beyond its bounds; @p file leads the message.
Values completed(const Effect& effect, Values values, const CfaPattern& cfa,
                 const std::string& file);

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What values of an effect must be; private to what puts effects into a run.
#pragma once

#include "cg2raw/effect.h"

namespace cg2raw {

/// Throws Error if a parameter of @p effect belongs to a site that @p cfa has not; @p
/// file leads the message.
void check_sites(const Effect& effect, const CfaPattern& cfa, const std::string& file);
/// Throws Error unless @p values are one per parameter, each within its bounds; @p file
/// leads the message.
void check_values(const Effect& effect, const Values& values, const std::string& file);

} // namespace cg2raw

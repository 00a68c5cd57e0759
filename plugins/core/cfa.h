// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Numbers that a profile states per CFA site, per colour, or once for all.
#pragma once

#include "cg2raw/profile.h"

namespace cg2raw {

/// One number per site of @p cfa from 1 number (all sites), 3 (R, G, B) or one per
/// site. Throws Error for another count; its text lists those allowed.
std::vector<double> spread_over_sites(const std::vector<double>& numbers,
                                      const CfaPattern& cfa);
/// The fewest numbers that spread_over_sites() makes @p sites of.
std::vector<double> fewest_numbers(const std::vector<double>& sites,
                                   const CfaPattern& cfa);

/// Throws Error for a pattern that cfa_from_name() has no name for.
void check_cfa(const CfaPattern& cfa);

} // namespace cg2raw

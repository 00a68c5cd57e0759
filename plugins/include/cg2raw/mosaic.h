// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file 4 - Camera RGB -> one CFA plane.
#pragma once

#include "cg2raw/transform.h"

namespace cg2raw {

/// Keep one of three values per CFA site: a row of @p width pixels that starts at @p
/// at.
void mosaic(const float* const camera[3], const CfaPattern& cfa, Site at, int width,
            float* raw);

} // namespace cg2raw

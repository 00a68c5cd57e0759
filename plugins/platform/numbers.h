// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What some standard libraries lack of std::from_chars.
#pragma once

#include <string_view>

namespace cg2raw {

/// The number that @p text is, whole, in the C locale; NaN if it is none.
double number_in(std::string_view text);

} // namespace cg2raw

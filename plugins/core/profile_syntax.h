// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Whether a text is JSON that can be a profile's, before memory is spent on it.
#pragma once

#include "cg2raw/types.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace cg2raw {

/// The field "schema" of the profiles that are read and written.
constexpr int profile_version = 1;

/// A profile has some thousand numbers; a text beyond any of these is no profile. They
/// bound the reader's time, memory and stack whatever the text.
constexpr std::uintmax_t largest_profile = 16u << 20; ///< bytes
constexpr std::size_t most_profile_values = 250000;
constexpr std::size_t most_profile_depth = 32; ///< objects and lists in each other
constexpr std::size_t most_profile_fields = 1000; ///< of one object

/// Throws Error, led by @p file, unless @p json is JSON within these bounds in which no
/// object has a field twice.
void check_profile_syntax(std::string_view json, const std::string& file);
/// Throws Error if @p size is above largest_profile.
void check_profile_size(std::uintmax_t size, const std::string& file);

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Names of files that are being written, where they need one.
#pragma once

#include <string>

namespace cg2raw {

/// How many names are tried before "File exists" is an error.
constexpr int most_temporary_names = 100;

/// ".cg2raw-" and 16 hexadecimal digits that nobody can foresee: process numbers repeat
/// in containers, and a stranger may have put files there under names to be expected.
std::string temporary_ending();

} // namespace cg2raw

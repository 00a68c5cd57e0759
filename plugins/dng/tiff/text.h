// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Text of strangers made fit for messages, JSON and our own files.
#pragma once

#include <string>
#include <string_view>

namespace cg2raw {

/// @p text up to its first NUL, without outer blanks; control characters become blanks
/// and bytes that are no UTF-8 become question marks.
std::string printable_text(std::string_view text);

} // namespace cg2raw

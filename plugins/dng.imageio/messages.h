// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What a host prints when a file fails.
#pragma once

#include <string>

namespace cg2raw {

/// @p message of an exception, one line, led by @p file unless it names that already.
std::string led_by_name(const std::string& file, const std::string& message);

} // namespace cg2raw

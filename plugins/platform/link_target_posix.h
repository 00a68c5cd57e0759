// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Where the links of Linux and macOS lead.
#pragma once

#include <optional>
#include <string>

namespace cg2raw {

std::string folder_of(const std::string& path);

/// Where a file that is opened as @p path lies or would lie, unless its links lead in a
/// circle.
std::optional<std::string> link_target(std::string path);

} // namespace cg2raw

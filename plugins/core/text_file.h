// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Text files that a user names.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace cg2raw {

/// All of a regular file, whose size @p check_size may refuse by an Error. Throws Error
/// naming the path; @p remedy says what to give in place of a folder or a pipe.
std::string read_text_file(const std::filesystem::path& path, const std::string& remedy,
                           const std::function<void(std::uintmax_t)>& check_size);

} // namespace cg2raw

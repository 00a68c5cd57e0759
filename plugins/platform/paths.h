// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Paths: UTF-8 in all that is ours, the system's own for the standard library.
#pragma once

#include "cg2raw/types.h"

#include <filesystem>
#include <string>
#include <vector>

namespace cg2raw {

/// A path that std::fstream and std::filesystem take.
inline std::filesystem::path path_of(const std::string& utf8)
{
    return std::filesystem::u8path(utf8);
}

/// Throws Error for a path with a NUL character: the system would take it for a shorter
/// one.
inline void check_path(const std::string& path)
{
    if (path.find('\0') != std::string::npos)
        throw Error(path + ": the name holds a NUL character: choose another");
}

inline std::string utf8_of(const std::filesystem::path& path)
{
    return path.u8string();
}

/// An environment variable in UTF-8; empty if it is not set.
std::string environment(const char* name);

/// Between the folders of an environment variable: ':', on Windows ';'.
extern const char path_list_separator;

/// Whether @p text names a place, and is not the bare name of something.
bool has_folder(const std::string& text);

/// The names of what is in a folder, in the order of the system; of one that cannot be
/// read, none. As std::filesystem's iterator, which ends the process without memory.
std::vector<std::string> names_in(const std::filesystem::path& folder);

/// The folder of the library or program that this code is part of; empty if the system
/// does not say.
std::filesystem::path own_folder();

} // namespace cg2raw

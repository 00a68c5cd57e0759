// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file A folder that files are written to and that is empty again after each input.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace cg2raw::test {

/// In memory where the system has a file system there. Removed with all in it when the
/// program ends.
class ScratchFolder {
public:
    ScratchFolder();
    ~ScratchFolder();
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;

    const std::filesystem::path& path() const { return m_path; }
    /// Names of what lies in it.
    std::vector<std::string> names() const;
    void clear() const;

private:
    std::filesystem::path m_path;
};

/// How many descriptors the program has open; 0 where the system does not tell.
std::size_t open_descriptors();

} // namespace cg2raw::test

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "scratch_folder.h"

#include <algorithm>
#include <random>

namespace cg2raw::test {

namespace fs = std::filesystem;

ScratchFolder::ScratchFolder()
{
    std::error_code none;
    const fs::path memory = "/dev/shm";
    const fs::path parent
        = fs::is_directory(memory, none) ? memory : fs::temp_directory_path();
    std::random_device random;
    do
        m_path = parent / ("cg2raw-fuzz-" + std::to_string(random()));
    while (!fs::create_directory(m_path));
}

ScratchFolder::~ScratchFolder()
{
    std::error_code ignored;
    fs::remove_all(m_path, ignored);
}

std::vector<std::string> ScratchFolder::names() const
{
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(m_path))
        names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

void ScratchFolder::clear() const
{
    for (const std::string& name : names())
        fs::remove_all(m_path / name);
}

std::size_t open_descriptors()
{
    std::error_code error;
    const fs::directory_iterator all("/proc/self/fd", error);
    return error ? 0 : std::size_t(std::distance(begin(all), end(all)));
}

} // namespace cg2raw::test

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Linux and macOS.
#include "platform/paths.h"

#include <cstdlib>
#include <memory>

#include <dirent.h>
#include <dlfcn.h>

namespace cg2raw {

std::string environment(const char* name)
{
    const char* const value = std::getenv(name);
    return value ? value : "";
}

const char path_list_separator = ':';

bool has_folder(const std::string& text) { return text.find('/') != std::string::npos; }

std::vector<std::string> names_in(const std::filesystem::path& folder)
{
    const auto close = [](DIR* opened) { ::closedir(opened); };
    const std::unique_ptr<DIR, decltype(close)> opened(::opendir(folder.c_str()),
                                                       close);
    std::vector<std::string> names;
    while (opened) {
        const dirent* const entry = ::readdir(opened.get());
        if (!entry)
            break;
        const std::string name = entry->d_name;
        if (name != "." && name != "..")
            names.push_back(name);
    }
    return names;
}

std::filesystem::path own_folder()
{
    Dl_info info {};
    if (!dladdr(reinterpret_cast<const void*>(&own_folder), &info) || !info.dli_fname)
        return {};
    std::error_code ignored;
    return std::filesystem::weakly_canonical(info.dli_fname, ignored).parent_path();
}

} // namespace cg2raw

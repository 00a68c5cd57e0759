// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Windows.
#include "platform/paths.h"

#include <cstdlib>

#include <windows.h>

namespace cg2raw {

std::string environment(const char* name)
{
    const wchar_t* const value = ::_wgetenv(path_of(name).c_str());
    return value ? utf8_of(value) : "";
}

const char path_list_separator = ';';

bool has_folder(const std::string& text)
{
    return text.find_first_of("/\\") != std::string::npos;
}

std::vector<std::string> names_in(const std::filesystem::path& folder)
{
    std::vector<std::string> names;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
        names.push_back(utf8_of(entry.path().filename()));
    return names;
}

std::filesystem::path own_folder()
{
    constexpr DWORD flags = GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS
        | GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT;
    HMODULE module = nullptr;
    if (!::GetModuleHandleExW(flags, reinterpret_cast<const wchar_t*>(&own_folder),
                              &module))
        return {};
    std::wstring name(32768, L'\0'); // the longest path that Windows has
    name.resize(::GetModuleFileNameW(module, name.data(), DWORD(name.size())));
    return std::filesystem::path(name).parent_path();
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "platform/link_target_posix.h"

#include <cerrno>
#include <climits>
#include <cstdlib>
#include <memory>

#include <unistd.h>

namespace cg2raw {
namespace {

/// What the symbolic link at @p path says; empty if it is none.
std::string text_of_link(const std::string& path)
{
    std::string text(PATH_MAX, '\0');
    const ssize_t size = ::readlink(path.c_str(), text.data(), text.size());
    text.resize(size > 0 ? std::size_t(size) : 0);
    return text;
}

} // namespace

std::string folder_of(const std::string& path)
{
    const std::size_t slash = path.rfind('/');
    if (slash == std::string::npos)
        return ".";
    return slash == 0 ? "/" : path.substr(0, slash);
}

std::optional<std::string> link_target(std::string path)
{
    constexpr int most_links = 40; // as Linux has it
    for (int links = 0; links < most_links; ++links) {
        const std::unique_ptr<char, decltype(&std::free)> real(
            ::realpath(path.c_str(), nullptr), &std::free);
        if (real)
            return real.get();
        if (errno == ELOOP)
            break;
        // One that leads to no file yet; what else is wrong, open() will say.
        const std::string text = errno == ENOENT ? text_of_link(path) : "";
        if (text.empty())
            return path;
        path = text.front() == '/' ? text : folder_of(path) + "/" + text;
    }
    return std::nullopt;
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "text_file.h"

#include "cg2raw/types.h"
#include "platform/paths.h"

#include <cerrno>
#include <fstream>
#include <new>

namespace cg2raw {

namespace fs = std::filesystem;

std::string read_text_file(const fs::path& path, const std::string& remedy,
                           const std::function<void(std::uintmax_t)>& check_size)
{
    std::error_code error;
    if (fs::is_directory(path, error))
        throw Error(utf8_of(path) + ": is a folder: " + remedy);
    const bool is_other = fs::is_other(path, error); // a pipe, a device or a socket
    const auto size = is_other ? 0 : fs::file_size(path, error);
    if (is_other || error)
        throw Error(utf8_of(path) + ": "
                    + (is_other ? "is no regular file" : error.message()) + ": "
                    + remedy);
    check_size(size);
    std::string text(std::size_t(size), '\0');
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    if (!file.is_open() && errno == ENOMEM)
        throw std::bad_alloc();
    try {
        file.exceptions(std::ios::badbit); // else it keeps what memory lacked to itself
        file.read(text.data(), std::streamsize(size));
    } catch (const std::ios::failure&) {
        file.close();
    }
    if (!file.is_open())
        throw Error(utf8_of(path) + ": cannot be read: check its permissions");
    text.resize(std::size_t(file.gcount()));
    return text;
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What a system has to say about a file that is not there yet: open, write, give
/// it its name. One source per system.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <system_error>

namespace cg2raw {

/// A file that has its name from publish() on, and is gone if that never comes: see
/// AtomicFile for what each system promises.
class NewFile {
public:
    /// Opens beside @p path (UTF-8), whose symbolic links are followed; one that leads
    /// to no file yet makes that file, but on Windows. An older file's permissions are
    /// kept; a new one has what the umask leaves. With @p sync its bytes are on the
    /// disk before it has its name. With @p unnamed false as on file systems that know
    /// no files without a name. Throws Error: missing or unwritable folder; @p path is
    /// no regular file, or read-only, or its links lead in a circle, or on Windows
    /// nowhere.
    explicit NewFile(const std::string& path, bool sync = true, bool unnamed = true);
    /// As the first, at @p name in the open folder @p folder; on Windows, which opens
    /// none, @p name is the file's path. A link of that name is replaced, and not
    /// followed. Errors name @p path.
    NewFile(int folder, const std::string& name, const std::string& path,
            bool sync = true, bool unnamed = true);
    ~NewFile();

    /// All of @p size bytes at @p offset, or the system's reason.
    std::error_code write(const void* data, std::size_t size,
                          std::uint64_t offset) noexcept;
    /// Bytes read, less than @p size at the end of the file.
    std::size_t read(void* data, std::size_t size, std::uint64_t offset) noexcept;
    /// Throws Error; an older file is then as it was, but for a failure to write the
    /// folder, when either may be there after a loss of power.
    void publish();

private:
    struct State;
    std::unique_ptr<State> m_state;
};

/// Words for an error of the system, the same on each where they mean the same.
std::string words_of(const std::error_code& error);

} // namespace cg2raw

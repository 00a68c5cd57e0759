// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file A file that appears under its name complete, or not at all.
#pragma once

#include "platform/new_file.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <system_error>

namespace cg2raw {

/// A file without a name until publish(): not even kill -9 leaves something behind, on
/// Linux's file systems with O_TMPFILE (ext4, xfs, btrfs, tmpfs). Elsewhere (NFS, SMB,
/// exFAT, macOS) it carries a hidden temporary name in the same folder, which every
/// failure but kill -9 removes; on Windows such a name, which goes with the process.
class AtomicFile {
public:
    /// Opens beside @p path, whose symbolic links are followed; one that leads to no
    /// file yet makes that file, but on Windows. An older file's permissions are kept;
    /// a new one has what the umask leaves. With @p sync its bytes are on the disk
    /// before it has its name.
    /// With @p unnamed false as on file systems that know no files without a name.
    /// Throws Error: missing or unwritable folder; @p path is no regular file, or
    /// read-only, or its links lead in a circle, or on Windows nowhere.
    explicit AtomicFile(std::string path, bool sync = true, bool unnamed = true);

    /// All of @p size bytes at @p offset. False, with the reason kept for fail(), if
    /// the system refuses or the file would pass 4 GiB, the limit of TIFF's 32-bit
    /// offsets.
    bool write(const void* data, std::size_t size, std::uint64_t offset) noexcept;
    /// Bytes read, less than @p size at the end of the file.
    std::size_t read(void* data, std::size_t size, std::uint64_t offset) noexcept;
    std::uint64_t size() const { return m_size; }

    /// Whether a write() was refused.
    bool has_failed() const { return m_reason || m_is_too_large; }

    /// Give it its name, replacing an older file in one step, once the system has taken
    /// all of it. Throws Error; an older file is then as it was, but for a failure to
    /// write the folder, when either may be there after a loss of power.
    void publish();

    /// Throws Error: path, what could not be done, and the first reason that write()
    /// met, else @p otherwise.
    [[noreturn]] void fail(const std::string& what, const std::string& otherwise) const;

private:
    std::string m_path; ///< as given, for messages
    std::error_code m_reason; ///< of the first failed write
    bool m_is_too_large = false; ///< it would have passed 4 GiB
    std::uint64_t m_size = 0;
    NewFile m_file;
};

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "tiff/atomic_file.h"

#include "cg2raw/types.h"

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <memory>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace cg2raw {

namespace {

/// Offsets of classic TIFF have 32 bits.
constexpr std::uint64_t tiff_limit = 0xffffffff;

std::string folder_of(const std::string& path)
{
    const std::size_t slash = path.rfind('/');
    if (slash == std::string::npos)
        return ".";
    return slash == 0 ? "/" : path.substr(0, slash);
}

std::string link_target(const std::string& path)
{
    const std::unique_ptr<char, decltype(&std::free)> real(
        ::realpath(path.c_str(), nullptr), &std::free);
    return real ? std::string(real.get()) : path;
}

/// A hidden name beside @p target that no other writer of this machine has.
std::string temporary_name(const std::string& target)
{
    static std::atomic<unsigned> count { 0 };
    const std::size_t slash = target.rfind('/');
    const std::size_t base = slash == std::string::npos ? 0 : slash + 1;
    // A name has 255 bytes at most: the tail of a long one is dropped.
    return target.substr(0, base) + "." + target.substr(base, 200) + ".cg2raw-"
        + std::to_string(::getpid()) + "-" + std::to_string(count++);
}

std::string descriptor_path(int file)
{
    return "/proc/self/fd/" + std::to_string(file);
}

/// fsync(); files that cannot be synchronised are as good as they will be.
int sync(int file)
{
    int result = -1;
    do
        result = ::fsync(file);
    while (result != 0 && errno == EINTR);
    return result != 0 && errno == EINVAL ? 0 : result;
}

[[noreturn]] void fail_with(const std::string& path, const std::string& what, int error)
{
    throw Error(path + ": cannot " + what + ": " + std::strerror(error));
}

} // namespace

AtomicFile::AtomicFile(std::string path, bool sync, bool unnamed)
    : m_path(std::move(path))
    , m_target(link_target(m_path))
    , m_sync(sync)
{
    struct stat status;
    if (::stat(m_target.c_str(), &status) == 0) {
        if (!S_ISREG(status.st_mode))
            throw Error(m_path + ": is not a regular file: choose another name");
        if (::access(m_target.c_str(), W_OK) != 0)
            fail_with(m_path, "replace", errno);
        m_mode = status.st_mode & 0777;
    }
    if (unnamed)
        open_unnamed(folder_of(m_target));
    if (m_file < 0)
        open_named();
}

void AtomicFile::open_unnamed(const std::string& folder)
{
#ifdef O_TMPFILE
    m_file = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, m_mode);
    if (m_file < 0) // kernels and file systems without it say one of these
        if (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL)
            fail_with(m_path, "create", errno);
    // Naming it later goes through /proc, which a container may lack.
    if (m_file >= 0 && ::access(descriptor_path(m_file).c_str(), F_OK) != 0) {
        ::close(m_file);
        m_file = -1;
    }
#else
    (void)folder;
#endif
}

void AtomicFile::open_named()
{
    std::string name;
    do {
        name = temporary_name(m_target);
        m_file = ::open(name.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, m_mode);
    } while (m_file < 0 && errno == EEXIST); // a process of this number left it
    if (m_file < 0)
        fail_with(m_path, "create", errno);
    m_temporary = name;
}

AtomicFile::~AtomicFile() { discard(); }

bool AtomicFile::write(const void* data, std::size_t size,
                       std::uint64_t offset) noexcept
{
    const char* from = static_cast<const char*>(data);
    if (offset + size > tiff_limit) {
        m_reason = "a TIFF file ends at 4 GiB: write a smaller image";
        return false;
    }
    while (size > 0) {
        const ssize_t done = ::pwrite(m_file, from, size, off_t(offset));
        if (done < 0 && errno == EINTR)
            continue;
        if (done <= 0) {
            if (m_reason.empty())
                m_reason = std::strerror(done == 0 ? ENOSPC : errno);
            return false;
        }
        from += done;
        size -= std::size_t(done);
        offset += std::uint64_t(done);
    }
    m_size = offset > m_size ? offset : m_size;
    return true;
}

std::size_t AtomicFile::read(void* data, std::size_t size,
                             std::uint64_t offset) noexcept
{
    std::size_t done = 0;
    while (done < size) {
        const ssize_t got = ::pread(m_file, static_cast<char*>(data) + done,
                                    size - done, off_t(offset + done));
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            break;
        done += std::size_t(got);
    }
    return done;
}

void AtomicFile::publish()
{
    flush();
    const std::string folder = folder_of(m_target);
    if (m_temporary.empty())
        link_unnamed();
    if (!m_temporary.empty() && ::rename(m_temporary.c_str(), m_target.c_str()) != 0)
        fail_with(m_path, "replace", errno);
    // The name is the file's now, and nothing below may take it away.
    m_temporary.clear();
    close_link();
    if (m_sync)
        sync_folder(folder);
}

/// Everything that the system may still refuse, while an older file stands untouched:
/// a full disk or quota shows as late as here, on network file systems at close().
void AtomicFile::flush()
{
    if (m_sync && sync(m_file) != 0)
        fail_with(m_path, "write", errno);
    // A file without a name needs a descriptor to be given one.
    const int link = m_temporary.empty() ? ::fcntl(m_file, F_DUPFD_CLOEXEC, 0) : -1;
    if (m_temporary.empty() && link < 0)
        fail_with(m_path, "write", errno);
    const int file = m_file;
    m_file = link;
    if (::close(file) != 0 && errno != EINTR)
        fail_with(m_path, "write", errno);
}

/// Makes the file's first name: the target itself, or where an older file has that, a
/// temporary one, since a link cannot replace a file and a rename can. Between the two
/// calls, and only there, the complete file has a temporary name.
void AtomicFile::link_unnamed()
{
    const std::string unnamed = descriptor_path(m_file);
    const auto link = [&](const std::string& name) {
        return ::linkat(AT_FDCWD, unnamed.c_str(), AT_FDCWD, name.c_str(),
                        AT_SYMLINK_FOLLOW)
            == 0;
    };
    if (link(m_target))
        return;
    while (errno == EEXIST) {
        const std::string name = temporary_name(m_target);
        if (link(name)) {
            m_temporary = name;
            return;
        }
    }
    fail_with(m_path, "create", errno);
}

void AtomicFile::close_link() noexcept
{
    if (m_file >= 0)
        ::close(m_file); // nothing was written by it
    m_file = -1;
}

/// Makes the new name outlast a loss of power.
void AtomicFile::sync_folder(const std::string& folder) const
{
    const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (file < 0)
        return; // a folder that may be written but not read
    const int error = sync(file) == 0 ? 0 : errno;
    ::close(file);
    if (error != 0)
        fail_with(m_path, "write its folder", error);
}

void AtomicFile::discard() noexcept
{
    if (m_file >= 0)
        ::close(m_file);
    if (!m_temporary.empty())
        ::unlink(m_temporary.c_str());
}

void AtomicFile::fail(const std::string& what, const std::string& otherwise) const
{
    throw Error(m_path + ": cannot " + what + ": "
                + (m_reason.empty() ? otherwise : m_reason));
}

} // namespace cg2raw

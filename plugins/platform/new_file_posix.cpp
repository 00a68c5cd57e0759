// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Linux and macOS. The latter has no files without a name.
#include "platform/new_file.h"

#include "cg2raw/types.h"
#include "platform/link_target_posix.h"
#include "platform/paths.h"
#include "platform/temporary_name.h"

#include <cerrno>
#include <optional>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace cg2raw {

struct NewFile::State {
    std::string path; ///< as given, for messages
    bool sync;
    int folder = -1; ///< that the file lies in: opened once, whatever its name leads to
    std::string name {}; ///< in it
    std::string temporary {}; ///< empty: the file has no name
    int file = -1;
    std::optional<mode_t> mode {}; ///< of an older file

    ~State() { discard(); } // also where the constructor of NewFile throws

    void open(int from, const std::string& target, bool replaces_links, bool unnamed);
    void find_older(bool replaces_links);
    void open_unnamed();
    template <typename Make> bool make_temporary(const Make& make);
    void open_named();
    void leave_streams();
    void keep_mode() const;
    mode_t first_mode() const { return mode.value_or(0666); }
    void flush();
    void link_unnamed();
    void close_link() noexcept;
    void sync_folder() const;
    void discard() noexcept;
    [[noreturn]] void fail(const std::string& what, int error = errno) const;
};

namespace {

std::error_code system_error(int error) { return { error, std::system_category() }; }

/// A hidden name beside @p name that no other writer has.
std::string temporary_name(const std::string& name)
{
    // It has 255 bytes at most: the tail of a long one is dropped.
    return "." + name.substr(0, 200) + temporary_ending();
}

/// Flags to open a folder that may be written but not read, where the system has them.
#if defined(O_PATH) // Linux
constexpr int by_place = O_PATH | O_DIRECTORY | O_CLOEXEC;
#elif defined(O_SEARCH) // macOS
constexpr int by_place = O_SEARCH | O_DIRECTORY | O_CLOEXEC;
#else
constexpr int by_place = O_RDONLY | O_DIRECTORY | O_CLOEXEC;
#endif

constexpr int beside_streams = STDERR_FILENO + 1; ///< and all numbers above it

std::string descriptor_path(int file)
{
    return "/proc/self/fd/" + std::to_string(file);
}

int sync_once(int file)
{
#ifdef F_FULLFSYNC // macOS, whose fsync() leaves bytes in the drive; not of all shares
    if (::fcntl(file, F_FULLFSYNC) == 0)
        return 0;
#endif
    return ::fsync(file);
}

/// Whether a file system says of a call that it has nothing of the kind.
bool is_lacking(int error)
{
    return error == EOPNOTSUPP || error == ENOTSUP || error == ENOSYS;
}

/// fsync(); files that cannot be synchronised are as good as they will be.
int sync_file(int file)
{
    int result = -1;
    do
        result = sync_once(file);
    while (result != 0 && errno == EINTR);
    return result != 0 && (errno == EINVAL || is_lacking(errno)) ? 0 : result;
}

} // namespace

NewFile::NewFile(const std::string& path, bool sync, bool unnamed)
    : m_state(new State { path, sync })
{
    check_path(path);
    const std::optional<std::string> target = link_target(path);
    if (!target)
        m_state->fail("create", ELOOP);
    m_state->open(AT_FDCWD, *target, false, unnamed);
}

NewFile::NewFile(int folder, const std::string& name, const std::string& path,
                 bool sync, bool unnamed)
    : m_state(new State { path, sync })
{
    check_path(name);
    m_state->open(folder, name, true, unnamed);
}

NewFile::~NewFile() = default;

std::error_code NewFile::write(const void* data, std::size_t size,
                               std::uint64_t offset) noexcept
{
    const char* from = static_cast<const char*>(data);
    while (size > 0) {
        const ssize_t done = ::pwrite(m_state->file, from, size, off_t(offset));
        if (done < 0 && errno == EINTR)
            continue;
        if (done <= 0)
            return system_error(done == 0 ? ENOSPC : errno);
        from += done;
        size -= std::size_t(done);
        offset += std::uint64_t(done);
    }
    return {};
}

std::size_t NewFile::read(void* data, std::size_t size, std::uint64_t offset) noexcept
{
    std::size_t done = 0;
    while (done < size) {
        const ssize_t got = ::pread(m_state->file, static_cast<char*>(data) + done,
                                    size - done, off_t(offset + done));
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            break;
        done += std::size_t(got);
    }
    return done;
}

void NewFile::publish()
{
    State& state = *m_state;
    state.flush();
    if (state.temporary.empty())
        state.link_unnamed();
    if (!state.temporary.empty()
        && ::renameat(state.folder, state.temporary.c_str(), state.folder,
                      state.name.c_str())
            != 0)
        state.fail("replace");
    // The name is the file's now, and nothing below may take it away.
    state.temporary.clear();
    state.close_link();
    if (state.sync)
        state.sync_folder();
}

/// @p target : where the file is to be, seen from the open folder @p from.
void NewFile::State::open(int from, const std::string& target, bool replaces_links,
                          bool unnamed)
{
    name = target.substr(target.rfind('/') + 1);
    folder = ::openat(from, folder_of(target).c_str(), by_place);
    if (folder < 0)
        fail("create");
    find_older(replaces_links);
    if (unnamed)
        open_unnamed();
    if (file < 0)
        open_named();
    leave_streams();
    keep_mode();
}

void NewFile::State::find_older(bool replaces_links)
{
    struct stat status;
    const char* older = name.empty() ? "." : name.c_str();
    if (::fstatat(folder, older, &status, AT_SYMLINK_NOFOLLOW) != 0
        || (replaces_links && S_ISLNK(status.st_mode)))
        return;
    if (!S_ISREG(status.st_mode))
        throw Error(path + ": is not a regular file: choose another name");
    if (::faccessat(folder, older, W_OK, 0) != 0)
        fail("replace");
    mode = status.st_mode & 0777;
}

void NewFile::State::open_unnamed()
{
#ifdef O_TMPFILE
    file = ::openat(folder, ".", O_TMPFILE | O_RDWR | O_CLOEXEC, first_mode());
    if (file < 0) // kernels and file systems without it say one of these
        if (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL)
            fail("create");
    // Naming it later goes through /proc, which a container may lack.
    if (file >= 0 && ::access(descriptor_path(file).c_str(), F_OK) != 0) {
        ::close(file);
        file = -1;
    }
#endif
}

/// Has a call make a name that no other writer has; otherwise errno is that of the
/// call.
template <typename Make> bool NewFile::State::make_temporary(const Make& make)
{
    for (int tries = 0; tries < most_temporary_names; ++tries) {
        std::string tried = temporary_name(name);
        if (make(tried)) {
            temporary.swap(tried);
            return true;
        }
        if (errno != EEXIST)
            break;
    }
    return false;
}

void NewFile::State::open_named()
{
    const auto open = [&](const std::string& tried) {
        file = ::openat(folder, tried.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC,
                        first_mode());
        return file >= 0;
    };
    if (!make_temporary(open))
        fail("create");
}

/// Where a host has closed a standard stream, its number is not the file's: what the
/// host prints would go into it.
void NewFile::State::leave_streams()
{
    if (file > STDERR_FILENO)
        return;
    const int stream = file;
    file = ::fcntl(stream, F_DUPFD_CLOEXEC, beside_streams);
    const int error = errno;
    ::close(stream);
    if (file < 0)
        fail("create", error);
}

/// An older file's permissions, whatever the umask; a new one has what that leaves.
void NewFile::State::keep_mode() const
{
    struct stat status;
    if (!mode || ::fstat(file, &status) != 0 || (status.st_mode & 0777) == *mode)
        return;
    // File systems without permissions refuse, and have none to keep.
    if (::fchmod(file, *mode) != 0 && errno != EPERM && !is_lacking(errno))
        fail("keep its permissions");
}

/// Everything that the system may still refuse, while an older file stands untouched:
/// a full disk or quota shows as late as here, on network file systems at close().
void NewFile::State::flush()
{
    if (sync && sync_file(file) != 0)
        fail("write");
    // A file without a name needs a descriptor to be given one.
    const int link
        = temporary.empty() ? ::fcntl(file, F_DUPFD_CLOEXEC, beside_streams) : -1;
    if (temporary.empty() && link < 0)
        fail("write");
    const int written = file;
    file = link;
    if (::close(written) != 0 && errno != EINTR)
        fail("write");
}

/// Makes the file's first name: the target itself, or where an older file has that, a
/// temporary one, since a link cannot replace a file and a rename can. Between the two
/// calls, and only there, the complete file has a temporary name.
void NewFile::State::link_unnamed()
{
    const std::string unnamed = descriptor_path(file);
    const auto link = [&](const std::string& first) {
        return ::linkat(AT_FDCWD, unnamed.c_str(), folder, first.c_str(),
                        AT_SYMLINK_FOLLOW)
            == 0;
    };
    if (!link(name) && (errno != EEXIST || !make_temporary(link)))
        fail("create");
}

void NewFile::State::close_link() noexcept
{
    if (file >= 0)
        ::close(file); // nothing was written by it
    file = -1;
}

/// Makes the new name outlast a loss of power.
void NewFile::State::sync_folder() const
{
    const int readable = ::openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (readable < 0)
        return; // a folder that may be written but not read
    const int error = sync_file(readable) == 0 ? 0 : errno;
    ::close(readable);
    if (error != 0)
        fail("write its folder", error);
}

void NewFile::State::discard() noexcept
{
    close_link();
    if (!temporary.empty())
        ::unlinkat(folder, temporary.c_str(), 0);
    if (folder >= 0)
        ::close(folder);
}

void NewFile::State::fail(const std::string& what, int error) const
{
    throw Error(path + ": cannot " + what + ": " + words_of(system_error(error)));
}

std::string words_of(const std::error_code& error) { return error.message(); }

} // namespace cg2raw

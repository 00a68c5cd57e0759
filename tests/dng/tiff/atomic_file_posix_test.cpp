// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What Linux and macOS have: modes, pipes, limits of a process.
#include "tiff/atomic_file.h"

#include "writer_fixture.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <set>

namespace cg2raw {
namespace {

using cg2raw::testing::bytes_of;
using cg2raw::testing::message_of;
namespace fs = std::filesystem;

class PosixAtomicFiles : public cg2raw::testing::InFolder { };

/// With files that have no name, and without.
class EitherPosixAtomicFile : public cg2raw::testing::InFolder,
                              public ::testing::WithParamInterface<bool> { };

INSTANTIATE_TEST_SUITE_P(Systems, EitherPosixAtomicFile, ::testing::Values(true, false),
                         [](const auto& info) {
                             return info.param ? "unnamed" : "named";
                         });

/// Standard input and error, closed for as long as it lives: the folder takes one of
/// their numbers, its file would take the other.
class NoStreams {
public:
    NoStreams()
    {
        ::close(STDIN_FILENO);
        ::close(STDERR_FILENO);
    }
    ~NoStreams()
    {
        ::dup2(m_input, STDIN_FILENO);
        ::dup2(m_error, STDERR_FILENO);
        ::close(m_input);
        ::close(m_error);
    }

private:
    int m_input = ::dup(STDIN_FILENO), m_error = ::dup(STDERR_FILENO);
};

TEST_P(EitherPosixAtomicFile, HoldNothingThatAHostPrints)
{
    {
        const NoStreams closed;
        AtomicFile file(path(), true, GetParam());
        ASSERT_TRUE(file.write("new", 3, 0));
        EXPECT_EQ(::write(STDERR_FILENO, "warning", 7), -1);
        file.publish();
    }
    EXPECT_EQ(bytes_of(path()), "new");
    EXPECT_EQ(files(), 1);
}

/// For as long as it lives.
class Umask {
public:
    explicit Umask(mode_t mask)
        : m_before(::umask(mask))
    {
    }
    ~Umask() { ::umask(m_before); }

private:
    mode_t m_before;
};

TEST_P(EitherPosixAtomicFile, KeepAModeThatTheUmaskForbids)
{
    const Umask umask(0027);
    // Without set-user-ID, which is not given to other bytes.
    for (const unsigned mode : { 0666U, 0664U, 0777U, 0640U, 0600U, 04755U }) {
        std::ofstream(path()) << "old";
        fs::permissions(path(), fs::perms(mode));
        AtomicFile file(path(), true, GetParam());
        ASSERT_TRUE(file.write("new", 3, 0));
        file.publish();
        EXPECT_EQ(fs::status(path()).permissions(), fs::perms(mode & 0777U));
    }
}

TEST_P(EitherPosixAtomicFile, HaveTheModeThatTheUmaskLeaves)
{
    const Umask umask(0027);
    AtomicFile file(path(), true, GetParam());
    ASSERT_TRUE(file.write("new", 3, 0));
    file.publish();
    EXPECT_EQ(fs::status(path()).permissions(), fs::perms(0640));
}

TEST_P(EitherPosixAtomicFile, MakeTheFileThatALinkLeadsTo)
{
    fs::create_directory(folder / "elsewhere");
    fs::create_symlink("elsewhere/later.dng", path("link.dng"));
    fs::create_symlink(folder / "link.dng", path());
    for (const std::string text : { "new", "newer" }) {
        AtomicFile file(path(), true, GetParam());
        ASSERT_TRUE(file.write(text.data(), text.size(), 0));
        file.publish();
        EXPECT_TRUE(fs::is_symlink(path()) && fs::is_symlink(path("link.dng")));
        EXPECT_EQ(bytes_of(path("elsewhere/later.dng")), text);
    }
}

TEST_P(EitherPosixAtomicFile, StayInTheFolderThatWasOpened)
{
    fs::create_directory(folder / "shots");
    fs::create_directory(folder / "elsewhere");
    std::ofstream(path("shots/shot.dng")) << "old";
    const auto swap = [&] {
        fs::rename(folder / "shots", folder / "moved");
        fs::create_directory_symlink("elsewhere", folder / "shots");
    };
    {
        AtomicFile file(path("shots/shot.dng"), true, GetParam());
        swap();
        ASSERT_TRUE(file.write("new", 3, 0));
        file.publish();
    }
    EXPECT_EQ(bytes_of(path("moved/shot.dng")), "new");
    {
        AtomicFile given_up(path("moved/shot.dng"), true, GetParam());
        fs::rename(folder / "moved", folder / "again");
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(folder / "again"), {}), 1);
    EXPECT_TRUE(fs::is_empty(folder / "elsewhere"));
}

TEST_P(EitherPosixAtomicFile, ReplaceALinkInAnOpenFolder)
{
    fs::create_directory(folder / "shots");
    std::ofstream(path("precious")) << "do not lose this";
    fs::create_symlink("../precious", path("shots/shot.dng"));
    const int opened = ::open(path("shots").c_str(), O_RDONLY | O_DIRECTORY);
    NewFile file(opened, "shot.dng", "said", true, GetParam());
    ::close(opened);
    fs::rename(folder / "shots", folder / "moved");
    ASSERT_FALSE(file.write("new", 3, 0));
    file.publish();
    EXPECT_FALSE(fs::is_symlink(path("moved/shot.dng")));
    EXPECT_EQ(bytes_of(path("moved/shot.dng")), "new");
    EXPECT_EQ(bytes_of(path("precious")), "do not lose this");
    EXPECT_EQ(files(), 2);
    EXPECT_EQ(message_of([&] { NewFile closed(-1, "shot.dng", "said"); }),
              "said: cannot create: Bad file descriptor");
}

TEST_P(EitherPosixAtomicFile, LieInAFolderThatCannotBeRead)
{
    fs::permissions(folder, fs::perms(0300));
    for (int i = 0; i < 2; ++i) {
        AtomicFile file(path(), true, GetParam());
        ASSERT_TRUE(file.write("new", 3, 0));
        file.publish();
    }
    fs::permissions(folder, fs::perms(0755));
    EXPECT_EQ(bytes_of(path()), "new");
}

TEST_P(EitherPosixAtomicFile, RefuseLinksInACircle)
{
    fs::create_symlink("there.dng", path());
    fs::create_symlink(path(), path("there.dng"));
    EXPECT_EQ(message_of([&] { AtomicFile file(path(), true, GetParam()); }),
              path() + ": cannot create: Too many levels of symbolic links");
    EXPECT_TRUE(fs::is_symlink(path()));
}

TEST_F(PosixAtomicFiles, HaveTemporaryNamesThatNobodyForesees)
{
    // 64 bits: two of 100 names share the first 32 once in a million runs.
    std::set<std::string> beginnings;
    for (int i = 0; i < 100; ++i) {
        AtomicFile file(path(), false, false);
        for (const auto& entry : fs::directory_iterator(folder)) {
            const std::string name = entry.path().filename();
            const std::string ending = name.substr(name.rfind('-') + 1);
            EXPECT_EQ(ending.size(), 16U) << name;
            beginnings.insert(ending.substr(0, 8));
        }
    }
    EXPECT_EQ(beginnings.size(), 100U);
}

TEST_F(PosixAtomicFiles, RefuseAFolderThatCannotBeWritten)
{
    // As root permissions do not bind; /proc refuses root, too.
    const std::string message = message_of([&] { AtomicFile file("/proc/shot.dng"); });
    EXPECT_EQ(message.rfind("/proc/shot.dng: cannot create: ", 0), 0U) << message;
    if (::geteuid() == 0)
        return;
    fs::permissions(folder, fs::perms(0555));
    EXPECT_EQ(message_of([&] { AtomicFile file(path()); }),
              path() + ": cannot create: Permission denied");
    fs::permissions(folder, fs::perms(0755));
}

TEST_F(PosixAtomicFiles, RefuseWhatIsNoFile)
{
    ASSERT_EQ(::mkfifo(path().c_str(), 0600), 0);
    EXPECT_EQ(message_of([&] { AtomicFile file(path()); }),
              path() + ": is not a regular file: choose another name");
    EXPECT_EQ(message_of([&] { AtomicFile file(folder.string()); }),
              folder.string() + ": is not a regular file: choose another name");
    EXPECT_EQ(message_of([&] { AtomicFile file("/dev/null"); }),
              "/dev/null: is not a regular file: choose another name");
}

/// The soft limit on a file's size, for as long as it lives; writing beyond it is
/// EFBIG.
class FileSizeLimit {
public:
    explicit FileSizeLimit(rlim_t bytes)
    {
        std::signal(SIGXFSZ, SIG_IGN);
        ::getrlimit(RLIMIT_FSIZE, &m_before);
        const rlimit limit { bytes, m_before.rlim_max };
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit()
    {
        ::setrlimit(RLIMIT_FSIZE, &m_before);
        std::signal(SIGXFSZ, SIG_DFL);
    }

private:
    rlimit m_before;
};

TEST_F(PosixAtomicFiles, ReportTheSystemsReason)
{
    const FileSizeLimit limit(10);
    AtomicFile file(path());
    EXPECT_FALSE(file.write("twelve bytes", 12, 0));
    EXPECT_EQ(message_of([&] { file.fail("write", "?"); }),
              path() + ": cannot write: File too large");
}

} // namespace
} // namespace cg2raw

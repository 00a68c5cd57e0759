// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "tiff/atomic_file.h"

#include "writer_fixture.h"

#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>

namespace cg2raw {
namespace {

using cg2raw::testing::bytes_of;
using cg2raw::testing::message_of;
namespace fs = std::filesystem;

class AtomicFiles : public cg2raw::testing::InFolder { };

/// With files that have no name, and without.
class EitherAtomicFile : public cg2raw::testing::InFolder,
                         public ::testing::WithParamInterface<bool> {
protected:
    /// Files that a folder listing shows while one is being written.
    int open_files() const { return GetParam() ? 0 : 1; }
};

INSTANTIATE_TEST_SUITE_P(Systems, EitherAtomicFile, ::testing::Values(true, false),
                         [](const auto& info) {
                             return info.param ? "unnamed" : "named";
                         });

TEST_P(EitherAtomicFile, AppearOnlyWhenPublished)
{
    AtomicFile file(path(), true, GetParam());
    ASSERT_TRUE(file.write("abc", 3, 0));
    EXPECT_EQ(files(), open_files());
    EXPECT_FALSE(fs::exists(path()));
    file.publish();
    EXPECT_EQ(files(), 1);
    EXPECT_EQ(bytes_of(path()), "abc");
}

TEST_P(EitherAtomicFile, UnpublishedLeaveNothing)
{
    std::ofstream(path()) << "old";
    {
        AtomicFile file(path(), true, GetParam());
        ASSERT_TRUE(file.write("new", 3, 0));
        EXPECT_EQ(files(), 1 + open_files());
    }
    EXPECT_EQ(files(), 1);
    EXPECT_EQ(bytes_of(path()), "old");
}

TEST_P(EitherAtomicFile, ReplaceAFileAndKeepItsMode)
{
    std::ofstream(path()) << "an older, longer file";
    fs::permissions(path(), fs::perms(0640));
    AtomicFile file(path(), true, GetParam());
    ASSERT_TRUE(file.write("new", 3, 0));
    EXPECT_EQ(bytes_of(path()), "an older, longer file");
    file.publish();
    EXPECT_EQ(files(), 1);
    EXPECT_EQ(bytes_of(path()), "new");
    EXPECT_EQ(fs::status(path()).permissions(), fs::perms(0640));
}

TEST_P(EitherAtomicFile, FollowLinks)
{
    fs::create_directory(folder / "elsewhere");
    std::ofstream(path("elsewhere/real.dng")) << "old";
    fs::create_symlink("elsewhere/real.dng", path());
    AtomicFile file(path(), true, GetParam());
    ASSERT_TRUE(file.write("new", 3, 0));
    file.publish();
    EXPECT_TRUE(fs::is_symlink(path()));
    EXPECT_EQ(bytes_of(path("elsewhere/real.dng")), "new");
}

TEST_P(EitherAtomicFile, AreReadBackAndPatched)
{
    AtomicFile file(path(), true, GetParam());
    ASSERT_TRUE(file.write("abcdef", 6, 0));
    ASSERT_TRUE(file.write("XY", 2, 2));
    char text[8] = {};
    EXPECT_EQ(file.read(text, 8, 1), 5U);
    EXPECT_STREQ(text, "bXYef");
    EXPECT_EQ(file.size(), 6U);
}

TEST_P(EitherAtomicFile, NameTheFolderThatIsMissing)
{
    const std::string lost = path("no/such/folder/shot.dng");
    EXPECT_EQ(message_of([&] { AtomicFile file(lost, true, GetParam()); }),
              lost + ": cannot create: No such file or directory");
}

TEST_F(AtomicFiles, RefuseAFolderThatCannotBeWritten)
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

TEST_F(AtomicFiles, RefuseWhatIsNoFile)
{
    ASSERT_EQ(::mkfifo(path().c_str(), 0600), 0);
    EXPECT_EQ(message_of([&] { AtomicFile file(path()); }),
              path() + ": is not a regular file: choose another name");
    EXPECT_EQ(message_of([&] { AtomicFile file(folder.string()); }),
              folder.string() + ": is not a regular file: choose another name");
    EXPECT_EQ(message_of([&] { AtomicFile file("/dev/null"); }),
              "/dev/null: is not a regular file: choose another name");
}

TEST_F(AtomicFiles, EndAtFourGigabytes)
{
    AtomicFile file(path());
    EXPECT_TRUE(file.write("x", 1, 0xfffffffe)); // sparse
    EXPECT_FALSE(file.write("x", 1, 0xffffffff));
    EXPECT_EQ(message_of([&] { file.fail("write", "?"); }),
              path()
                  + ": cannot write: a TIFF file ends at 4 GiB: write a smaller image");
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

TEST_F(AtomicFiles, ReportTheSystemsReason)
{
    const FileSizeLimit limit(10);
    AtomicFile file(path());
    EXPECT_FALSE(file.write("twelve bytes", 12, 0));
    EXPECT_EQ(message_of([&] { file.fail("write", "?"); }),
              path() + ": cannot write: File too large");
}

} // namespace
} // namespace cg2raw

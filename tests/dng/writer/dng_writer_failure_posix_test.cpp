// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Full disks, limits and kill -9: one message, and nothing left behind.
#include "cg2raw/dng_writer.h"

#include "writer_fixture.h"

#ifdef __linux__
#include <sys/mount.h>
#endif
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>

namespace cg2raw {
namespace {

using namespace cg2raw::testing;

const Size size { 512, 512 };

class DngFailures : public InFolder, public ::testing::WithParamInterface<Compression> {
protected:
    DngOptions options() const { return { GetParam() }; }

    /// What writing to @p file says: by the exception, and nowhere else.
    std::string message(const std::string& file) const
    {
        ::testing::internal::CaptureStderr();
        const std::string text = thrown(file);
        EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
        return text;
    }

private:
    std::string thrown(const std::string& file) const
    {
        const std::vector<std::uint16_t> dn = mosaic_of(size);
        try {
            write_dng(file, plane_of(dn, size), description_of(size), options());
        } catch (const Error& error) {
            return error.what();
        }
        return "no error";
    }
};

TEST_P(DngFailures, FileSizeLimit)
{
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit before;
    ::getrlimit(RLIMIT_FSIZE, &before);
    // The header, the preview, the first strips, the directory at the end: each may
    // fail.
    for (const rlim_t bytes : { 4, 100000, 250000, 400000 }) {
        const rlimit limit { bytes, before.rlim_max };
        ::setrlimit(RLIMIT_FSIZE, &limit);
        const std::string text = message(path());
        ::setrlimit(RLIMIT_FSIZE, &before);
        EXPECT_EQ(text, path() + ": cannot write: File too large") << bytes;
        EXPECT_EQ(files(), 0) << bytes;
    }
    std::signal(SIGXFSZ, SIG_DFL);
}

#ifdef __linux__
TEST_P(DngFailures, FullDisk)
{
    if (::mount("none", folder.c_str(), "tmpfs", 0, "size=300k") != 0)
        GTEST_SKIP() << "cannot mount a small tmpfs: " << std::strerror(errno);
    const std::string text = message(path());
    const int left = files();
    ::umount(folder.c_str());
    EXPECT_EQ(text, path() + ": cannot write: No space left on device");
    EXPECT_EQ(left, 0);
}

TEST_P(DngFailures, ReadOnlyFileSystem)
{
    if (::mount("none", folder.c_str(), "tmpfs", MS_RDONLY, "size=300k") != 0)
        GTEST_SKIP() << "cannot mount a read-only tmpfs: " << std::strerror(errno);
    const std::string text = message(path());
    ::umount(folder.c_str());
    EXPECT_EQ(text, path() + ": cannot create: Read-only file system");
}
#endif

TEST_P(DngFailures, MissingFolder)
{
    EXPECT_EQ(message(path("lost/shot.dng")),
              path("lost/shot.dng") + ": cannot create: No such file or directory");
}

TEST_P(DngFailures, KilledWhileWriting)
{
    std::ofstream(path("old.dng")) << "old";
    for (const std::string name : { "new.dng", "old.dng" }) {
        const pid_t child = ::fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            const std::vector<std::uint16_t> dn = mosaic_of(size);
            DngWriter writer(path(name), description_of(size), options());
            writer.write_rows(plane_of(dn, { size.width, size.height - 1 }));
            ::raise(SIGKILL);
        }
        int status = 0;
        ASSERT_EQ(::waitpid(child, &status, 0), child);
        ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
        EXPECT_EQ(files(), 1) << name;
        EXPECT_EQ(bytes_of(path("old.dng")), "old");
    }
}

INSTANTIATE_TEST_SUITE_P(Compressions, DngFailures,
                         ::testing::Values(Compression::none, Compression::ljpeg),
                         [](const auto& info) {
                             return info.param == Compression::none ? "none" : "ljpeg";
                         });

} // namespace
} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "tiff/atomic_file.h"

#include "writer_fixture.h"

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
    static int open_files()
    {
#ifdef __linux__ // elsewhere there are no files without a name
        return GetParam() ? 0 : 1;
#else
        return 1;
#endif
    }
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

TEST_P(EitherAtomicFile, ReplaceAFile)
{
    std::ofstream(path()) << "an older, longer file";
    AtomicFile file(path(), true, GetParam());
    ASSERT_TRUE(file.write("new", 3, 0));
    EXPECT_EQ(bytes_of(path()), "an older, longer file");
    file.publish();
    EXPECT_EQ(files(), 1);
    EXPECT_EQ(bytes_of(path()), "new");
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

TEST_P(EitherAtomicFile, HaveNamesInUtf8)
{
    const std::string name = path("h\xc3\xa4user-\xe5\xae\xb6.dng");
    AtomicFile file(name, true, GetParam());
    ASSERT_TRUE(file.write("abc", 3, 0));
    file.publish();
    EXPECT_EQ(bytes_of(path_of(name)), "abc");
}

TEST_P(EitherAtomicFile, HavePathsOfAnyLength)
{
    // Windows asks for a mark in front of paths that are longer than 260.
    const std::string lost = path(std::string(200, 'x') + "/" + std::string(200, 'y'));
    EXPECT_EQ(message_of([&] { AtomicFile file(lost, true, GetParam()); }),
              lost + ": cannot create: No such file or directory");
}

TEST_P(EitherAtomicFile, RefuseToReplaceAFileThatIsReadOnly)
{
    std::ofstream(path_of(path())) << "old";
    fs::permissions(path_of(path()), fs::perms(0444));
    const std::string message
        = message_of([&] { AtomicFile file(path(), true, GetParam()); });
    fs::permissions(path_of(path()), fs::perms(0644));
    if (message == "no error")
        GTEST_SKIP() << "permissions do not bind this user";
    EXPECT_EQ(message, path() + ": cannot replace: Permission denied");
    EXPECT_EQ(bytes_of(path_of(path())), "old");
}

TEST_P(EitherAtomicFile, NameTheFolderThatIsMissing)
{
    const std::string lost = path("no/such/folder/shot.dng");
    EXPECT_EQ(message_of([&] { AtomicFile file(lost, true, GetParam()); }),
              lost + ": cannot create: No such file or directory");
}

TEST_F(AtomicFiles, RefuseAFolder)
{
    EXPECT_EQ(message_of([&] { AtomicFile file(utf8_of(folder)); }),
              utf8_of(folder) + ": is not a regular file: choose another name");
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

} // namespace
} // namespace cg2raw

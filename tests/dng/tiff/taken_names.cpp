// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file A program of its own, since it says which temporary names there are.
#include "platform/temporary_name.h"
#include "tiff/atomic_file.h"
#include "writer_fixture.h"

namespace cg2raw {
namespace {

int names_made = 0; ///< of one file
using TakenNames = testing::InFolder;

TEST_F(TakenNames, AreNotFollowedNorTheLast)
{
    for (const bool unnamed : { true, false }) {
        names_made = 0;
        for (const char* name : { "shot.dng", "precious", ".shot.dng.1" })
            std::ofstream(path(name)) << "a stranger's";
        std::filesystem::remove(path(".shot.dng.2"));
        std::filesystem::create_symlink("precious", path(".shot.dng.2"));
        AtomicFile file(path(), true, unnamed);
        ASSERT_TRUE(file.write("new", 3, 0));
        file.publish();
        EXPECT_EQ(names_made, 3);
        EXPECT_EQ(testing::bytes_of(path()), "new");
        EXPECT_EQ(testing::bytes_of(path(".shot.dng.1")), "a stranger's");
        EXPECT_EQ(testing::bytes_of(path("precious")), "a stranger's");
        EXPECT_EQ(files(), 4);
    }
}

} // namespace

std::string temporary_ending() { return "." + std::to_string(++names_made); }

} // namespace cg2raw

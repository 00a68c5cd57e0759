// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file LinearRaw of one sample: the mosaic of a sensor without filters.
#include "reader_test.h"

#include <gtest/gtest.h>

namespace cg2raw::test {
namespace {

constexpr int linear_raw = 34892;

/// As tiny_dng(), without what a monochrome camera does not write.
Ifd mono_dng()
{
    Ifd ifd = tiny_dng();
    ifd.shorts(262, { linear_raw });
    for (const int tag : { 33421, 33422, 50710, 50713, 50721, 50728, 50778 })
        ifd.without(std::uint16_t(tag));
    ifd.shorts(50714, { 64 });
    return ifd;
}

TEST(MonoDng, HasOneSiteAndNoColours)
{
    for (const bool big_endian : { false, true }) {
        const DngMetadata metadata = read(mono_dng(), big_endian);
        EXPECT_EQ(name_of(metadata.cfa), "MONO");
        EXPECT_EQ(metadata.black_level, std::vector<double> { 64 });
        EXPECT_EQ(metadata.white_level, 1023);
        EXPECT_TRUE(metadata.calibrations.empty());
        EXPECT_FALSE(metadata.as_shot_neutral);
        const SensorProfile profile = profile_from_dng(metadata);
        EXPECT_EQ(to_json(parse_profile(to_json(profile), "again")), to_json(profile));
    }
}

TEST(MonoDng, NotesAMatrixAndDoesNotReadIt)
{
    Ifd ifd = mono_dng();
    ifd.shorts(50721, { 1 }); // would be an error of a file with colours
    const DngMetadata metadata = read(ifd);
    EXPECT_TRUE(has_note(metadata.notes, "ColorMatrix1 (50721) is not used"));
    EXPECT_TRUE(metadata.calibrations.empty());
}

TEST(MonoDng, HasNoiseOfOnePlane)
{
    Ifd ifd = mono_dng();
    ifd.doubles(51041, { 1e-4, 2e-7 });
    ASSERT_EQ(read(ifd).noise_profile.size(), 1U);
    ifd.doubles(51041, { 1e-4, 2e-7, 1e-4, 2e-7, 1e-4, 2e-7 });
    EXPECT_THROW(read(ifd), Error);
}

TEST(MonoDng, OfThreeSamplesIsNoMosaic)
{
    Ifd ifd = mono_dng();
    ifd.shorts(277, { 3 });
    EXPECT_THROW(read(ifd), Error);
}

} // namespace
} // namespace cg2raw::test

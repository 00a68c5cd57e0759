// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file DNGs with the tags of real cameras whose files are not at hand. The Nexus 5X
/// is in dng_reader_test.cpp. Source of the numbers: the cameras' files, as listed by
/// metadata-extractor's test images.
#include "reader_test.h"

#include <gtest/gtest.h>

namespace cg2raw::test {
namespace {

/// A preview in IFD0 and the mosaic in a SubIFD, without what not every maker writes.
Ifd bare(std::uint64_t width, std::uint64_t height, std::uint64_t white)
{
    Ifd ifd = tiny_dng_with_sub_ifds();
    for (int absent : { 50713, 50714 })
        ifd.sub_ifds[1].without(absent);
    ifd.sub_ifds[1].longs(256, { width }).longs(257, { height });
    ifd.sub_ifds[1].longs(50717, { white });
    ifd.shorts(50778, { 17 }).shorts(50779, { 21 });
    return ifd;
}

TEST(DngMakers, DjiPhantom4)
{
    Ifd ifd = bare(4000, 3000, 16383);
    ifd.text(271, "DJI").text(272, "FC330").text(50708, "FC330");
    ifd.signed_rationals(
        50721, { 11050, -7405, 1696, -1982, 7536, 5303, -89, 909, 5633 }, 10000);
    ifd.signed_rationals(
        50722, { 7497, -1964, -483, -3827, 11576, 2677, -1083, 2348, 6001 }, 10000);
    ifd.rationals(50727, { 1000000, 1000000, 1000000 }, 1000000);
    ifd.rationals(50728, { 560635, 1000000, 582480 }, 1000000);
    ifd.sub_ifds[1]
        .shorts(50713, { 2, 2 })
        .fractions(50714, { { 800, 1 }, { 800, 1 }, { 800, 1 }, { 800, 1 } });
    // List 1 corrects values as stored: its 74704 bytes are not needed.
    ifd.sub_ifds[1].bytes(51008, std::vector<std::uint64_t>(74704, 0));
    const DngMetadata metadata = read(ifd);
    EXPECT_EQ(metadata.black_level, std::vector<double>(4, 800.0));
    EXPECT_EQ(metadata.calibrations[0].camera_from_xyz(0, 0), 1.105);
    EXPECT_EQ(metadata.calibrations[1].light_source, 21);
    EXPECT_EQ((*metadata.as_shot_neutral)[0], 0.560635);
    const SensorProfile profile = profile_from_dng(metadata);
    EXPECT_EQ(profile.id, "fc330");
    EXPECT_EQ(profile.make, "DJI");
    EXPECT_EQ(profile.width, 4000);
    EXPECT_EQ(profile.bits, 14);
}

TEST(DngMakers, LeicaTHasNoBlackLevelAndItsNeutralHasThreeDenominators)
{
    Ifd ifd = bare(4944, 3278, 4095);
    ifd.text(271, "LEICA CAMERA AG").text(272, "LEICA T (Typ 701)");
    ifd.text(50708, "LEICA T (Typ 701)");
    ifd.signed_rationals(
        50721, { 5671, -1412, -89, -3833, 10711, 3616, -381, 845, 6868 }, 10000);
    ifd.signed_rationals(
        50722, { 5463, -988, -364, -4634, 12036, 2946, -766, 1389, 6522 }, 10000);
    ifd.fractions(50728, { { 256, 738 }, { 512, 512 }, { 256, 421 } });
    const DngMetadata metadata = read(ifd);
    EXPECT_EQ(metadata.black_level, std::vector<double>(4, 0.0));
    EXPECT_TRUE(has_note(metadata.notes, "BlackLevel (50714) is missing"));
    EXPECT_EQ((*metadata.as_shot_neutral)[0], 256.0 / 738.0);
    EXPECT_EQ((*metadata.as_shot_neutral)[2], 256.0 / 421.0);
    EXPECT_EQ(metadata.active_area.width, 4944); // no ActiveArea: the whole image
    EXPECT_EQ(profile_from_dng(metadata).id, "leica-t-typ-701");
    EXPECT_EQ(metadata.bits, 12);
}

TEST(DngMakers, PentaxQS1PadsItsNamesAndHasMatricesOver65536)
{
    Ifd ifd = bare(4064, 3000, 4062);
    ifd.text(271, "PENTAX             ").text(272, "PENTAX Q-S1        ");
    ifd.text(50708, "PENTAX Q-S1");
    ifd.signed_rationals(
        50721, { 133426, -88689, -7833, 10001, 41450, 17504, 6732, 523, 33211 }, 65536);
    ifd.signed_rationals(
        50722, { 85161, -36656, -7256, -12313, 66450, 13283, -421, 8080, 32236 },
        65536);
    ifd.fractions(50727, { { 1, 1 }, { 1, 1 }, { 1, 1 } });
    ifd.fractions(50728, { { 256, 451 }, { 256, 256 }, { 256, 436 } });
    Ifd& raw = ifd.sub_ifds[1];
    raw.shorts(50713, { 2, 2 }).shorts(50714, { 0, 0, 0, 0 });
    raw.longs(50829, { 0, 0, 3000, 4000 });
    const DngMetadata metadata = read(ifd);
    EXPECT_EQ(metadata.make, "PENTAX");
    EXPECT_EQ(metadata.calibrations[0].camera_from_xyz(0, 0), 133426.0 / 65536.0);
    EXPECT_EQ(metadata.active_area.width, 4000);
    EXPECT_EQ(metadata.white_level, 4062);
    EXPECT_EQ((*metadata.as_shot_neutral)[2], 256.0 / 436.0);
    EXPECT_EQ(profile_from_dng(metadata).model, "PENTAX Q-S1");
}

TEST(DngMakers, LinearizationLeavesItsTableAloneAndSaysSo)
{
    Ifd ifd = tiny_dng();
    ifd.shorts(50712, std::vector<std::uint64_t>(1024, 7)).longs(50717, { 51080 });
    const DngMetadata metadata = read(ifd);
    EXPECT_EQ(metadata.white_level, 51080);
    EXPECT_EQ(metadata.bits, 16);
    EXPECT_TRUE(
        has_note(metadata.notes, "LinearizationTable (50712): black, white and bits"));
}

TEST(DngMakers, NoiseOfFourPlanesIsUnknownToASensorOfThree)
{
    const DngMetadata metadata
        = read(tiny_dng()
                   .shorts(34855, { 100 })
                   .doubles(51041, { 1e-4, 1e-7, 2e-4, 2e-7, 3e-4, 3e-7, 4e-4, 4e-7 }));
    EXPECT_TRUE(metadata.noise_profile.empty());
    EXPECT_TRUE(has_note(metadata.notes, "NoiseProfile (51041) has 4 planes"));
}

} // namespace
} // namespace cg2raw::test

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file LinearRaw of three samples: demosaicked files, which do not say their CFA.
#include "reader_test.h"

#include <gtest/gtest.h>

namespace cg2raw::test {
namespace {

/// As tiny_dng_with_sub_ifds(), demosaicked.
Ifd linear_dng()
{
    Ifd ifd = tiny_dng_with_sub_ifds();
    Ifd& image = ifd.sub_ifds.at(1);
    image.shorts(262, { 34892 }).shorts(277, { 3 }).shorts(258, { 16, 16, 16 });
    image.without(33421).without(33422);
    image.shorts(50714, { 64, 65, 66 }).shorts(50717, { 1023, 1020, 1023 });
    return ifd;
}

DngMetadata read_as(const Ifd& ifd, const std::string& cfa)
{
    std::istringstream stream(file_of(ifd));
    return read_dng_stream(stream, "test.dng", cfa_from_name(cfa));
}

std::string refusal(const Ifd& ifd, const std::string& cfa)
{
    try {
        if (cfa.empty())
            read(ifd);
        else
            read_as(ifd, cfa);
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

TEST(LinearDng, HasTheCfaAsGivenAndLevelsByColour)
{
    const DngMetadata metadata = read_as(linear_dng(), "gbrg");
    EXPECT_EQ(name_of(metadata.cfa), "GBRG");
    EXPECT_EQ(metadata.black_level, (std::vector<double> { 65, 66, 64, 65 }));
    EXPECT_EQ(metadata.white_level, 1020);
    EXPECT_EQ(metadata.bits, 10);
    EXPECT_EQ(metadata.calibrations.size(), 1U);
    ASSERT_TRUE(metadata.as_shot_neutral);
    EXPECT_NEAR((*metadata.as_shot_neutral)[0], 0.522449, 1e-9);
    EXPECT_TRUE(has_note(metadata.notes, "the CFA GBRG is as given"));
    const SensorProfile profile = profile_from_dng(metadata);
    EXPECT_EQ(to_json(parse_profile(to_json(profile), "again")), to_json(profile));
}

TEST(LinearDng, OfARepeatOfBlackLevelsHasTheirMeansByColour)
{
    Ifd ifd = linear_dng();
    ifd.sub_ifds.at(1)
        .shorts(50713, { 1, 2 })
        .shorts(50714, { 60, 61, 62, 64, 65, 66 });
    const DngMetadata metadata = read_as(ifd, "rggb");
    EXPECT_EQ(metadata.black_level, (std::vector<double> { 60, 65, 61, 66 }));
}

TEST(LinearDng, AsksForTheCfa)
{
    const std::string said = refusal(linear_dng(), "");
    EXPECT_NE(said.find("does not reveal the sensor's CFA"), said.npos) << said;
    EXPECT_NE(said.find("--cfa RGGB"), said.npos) << said;
}

TEST(LinearDng, HasFilters)
{
    const std::string said = refusal(linear_dng(), "mono");
    EXPECT_NE(said.find("cfa MONO has no colours"), said.npos) << said;
}

TEST(LinearDng, OfAMosaicNoCfaIsTaken)
{
    const std::string said = refusal(tiny_dng(), "rggb");
    EXPECT_NE(said.find("says its own CFA"), said.npos) << said;
}

TEST(LinearDng, OfFourSamplesIsRefused)
{
    Ifd ifd = linear_dng();
    ifd.sub_ifds.at(1).shorts(277, { 4 });
    const std::string said = refusal(ifd, "rggb");
    EXPECT_NE(said.find("SamplesPerPixel (277)"), said.npos) << said;
}

TEST(LinearDng, TakesBackTheBalanceOfItsConverter)
{
    Ifd ifd = linear_dng();
    const DngMetadata plain = read_as(ifd, "rggb");
    ifd.rationals(50727, { 2000, 1000, 1500 }, 1000);
    ifd.rationals(50728, { 1000000, 1000000, 1000000 }, 1000000);
    const DngMetadata balanced = read_as(ifd, "rggb");
    EXPECT_NEAR((*balanced.as_shot_neutral)[0], 0.5, 1e-9);
    EXPECT_NEAR((*balanced.as_shot_neutral)[2], 1.0 / 1.5, 1e-9);
    for (std::size_t i = 0; i < 9; ++i)
        EXPECT_NEAR(balanced.calibrations[0].camera_from_xyz.m[i],
                    plain.calibrations[0].camera_from_xyz.m[i], 1e-12);
}

TEST(LinearDng, SaysWhatItsNoiseAndOpcodesAre)
{
    Ifd ifd = linear_dng();
    ifd.sub_ifds.at(1).doubles(51041, { 1e-4, 2e-7 });
    ifd.sub_ifds.at(1).bytes(51009, { 0, 0, 0, 0 });
    const DngMetadata metadata = read_as(ifd, "rggb");
    ASSERT_EQ(metadata.noise_profile.size(), 3U);
    EXPECT_TRUE(has_note(metadata.notes, "a mosaic is noisier"));
    EXPECT_TRUE(has_note(metadata.notes, "OpcodeList2 (51009) is of a demosaicked"));
    EXPECT_TRUE(metadata.gain_maps.empty());
}

} // namespace
} // namespace cg2raw::test

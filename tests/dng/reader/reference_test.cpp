// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "reader/metadata_parts.h"
#include "tiff_builder.h"

#include <gtest/gtest.h>

#include <sstream>

namespace cg2raw::test {
namespace {

DngMetadata read(const Ifd& ifd0)
{
    std::istringstream stream(file_of(ifd0));
    return read_dng_stream(stream, "folder/test.dng");
}

TEST(DngReference, NamesBecomeIds)
{
    EXPECT_EQ(sensor_id_from_name("GoPro HERO6 Black"), "gopro-hero6-black");
    EXPECT_EQ(sensor_id_from_name("LEICA T (Typ 701)"), "leica-t-typ-701");
    EXPECT_EQ(sensor_id_from_name("iPhone13,3 back camera"), "iphone13-3-back-camera");
    EXPECT_EQ(sensor_id_from_name(" \xE7\x9B\xB8 "), "");
    // 300 letters are no file's name; a word that begins at the cut is cut with it.
    EXPECT_EQ(sensor_id_from_name(std::string(300, 'X')), std::string(100, 'x'));
    EXPECT_EQ(sensor_id_from_name(std::string(99, 'X') + " Y"), std::string(99, 'x'));
}

TEST(DngReference, IsAProfileThatReadsBack)
{
    Ifd ifd = tiny_dng_with_sub_ifds();
    ifd.sub_ifds[1].doubles(51041, { 1e-4, 1e-7, 2e-4, 2e-7, 3e-4, 3e-7 });
    const SensorProfile profile = profile_from_dng(read(ifd));
    EXPECT_EQ(profile.id, "maker-model-1");
    EXPECT_EQ(profile.width, 8);
    EXPECT_EQ(profile.height, 6);
    EXPECT_EQ(profile.bits, 10);
    ASSERT_EQ(profile.illuminants.neutrals.size(), 1U);
    EXPECT_EQ(profile.illuminants.neutrals[0][0], 0.522449);
    EXPECT_EQ(profile.illuminants.neutrals[0][1], 0.571429);
    ASSERT_EQ(profile.noise.size(), 1U);
    EXPECT_EQ(profile.noise[0].iso, 400);
    EXPECT_EQ(profile.noise[0].beta1, (std::vector<double> { 1e-4, 2e-4, 2e-4, 3e-4 }));
    EXPECT_EQ(profile.noise[0].beta2, (std::vector<double> { 1e-7, 2e-7, 2e-7, 3e-7 }));
    for (const auto& [field, source] : profile.sources)
        EXPECT_EQ(source.find("folder"), std::string::npos) << field;
    const std::string json = to_json(profile);
    EXPECT_EQ(to_json(parse_profile(json, "profile")), json);
}

TEST(DngReference, NoiseNeedsAnIso)
{
    Ifd ifd = tiny_dng().doubles(51041, { 1e-4, 1e-7 });
    const DngMetadata metadata = read(ifd);
    ASSERT_FALSE(metadata.notes.empty());
    EXPECT_NE(metadata.notes.back().find("the ISO of NoiseProfile is unknown"),
              std::string::npos);
    EXPECT_TRUE(profile_from_dng(metadata).noise.empty());
}

TEST(DngReference, NeedsANeutral)
{
    const DngMetadata metadata = read(tiny_dng().without(50728));
    EXPECT_FALSE(metadata.as_shot_neutral);
    try {
        profile_from_dng(metadata);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what())
                      .rfind("folder/test.dng: AsShotNeutral (50728) is missing", 0),
                  0U);
    }
}

TEST(DngReference, NamesStandInForMissingOnes)
{
    const SensorProfile unique
        = profile_from_dng(read(tiny_dng().without(271).without(272)));
    EXPECT_EQ(unique.make, "Maker");
    EXPECT_EQ(unique.model, "Maker Model 1");
    Ifd ifd = tiny_dng().without(50708);
    EXPECT_EQ(profile_from_dng(read(ifd)).id, "maker-model-1");
    ifd.text(271, "NIKON CORPORATION").text(272, "NIKON D1");
    const SensorProfile nikon = profile_from_dng(read(ifd));
    EXPECT_EQ(nikon.id, "nikon-d1");
    EXPECT_EQ(nikon.unique_camera_model, "NIKON D1");
}

} // namespace
} // namespace cg2raw::test

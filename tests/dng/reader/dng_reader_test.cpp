// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/illuminant.h"

#include "reader_test.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace cg2raw::test {
namespace {

void expect_near(const Mat3& actual, const Mat3& expected, double tolerance)
{
    for (std::size_t i = 0; i < 9; ++i)
        EXPECT_NEAR(actual.m[i], expected.m[i], tolerance) << "entry " << i;
}

class BothByteOrders : public testing::TestWithParam<bool> { };

TEST_P(BothByteOrders, RawInIfd0)
{
    const DngMetadata metadata = read(tiny_dng(), GetParam());
    EXPECT_EQ(metadata.file, "test.dng");
    EXPECT_EQ(metadata.model, "Model 1");
    EXPECT_EQ(metadata.unique_camera_model, "Maker Model 1");
    EXPECT_EQ(metadata.active_area.width, 8);
    EXPECT_EQ(metadata.active_area.height, 6);
    EXPECT_EQ(name_of(metadata.cfa), "RGGB");
    EXPECT_EQ(metadata.black_level, (std::vector<double> { 64, 64, 64, 64 }));
    EXPECT_EQ(metadata.white_level, 1023);
    EXPECT_EQ(metadata.bits, 10);
    ASSERT_EQ(metadata.calibrations.size(), 1U);
    EXPECT_EQ(metadata.calibrations[0].light_source, 21);
    EXPECT_EQ(metadata.calibrations[0].camera_from_xyz(1, 0), -0.4420);
    EXPECT_EQ((*metadata.as_shot_neutral)[0], 0.522449);
    EXPECT_EQ((*metadata.as_shot_neutral)[2], 0.571429);
    EXPECT_FALSE(metadata.shot.iso || metadata.shot.exposure_time);
}

TEST_P(BothByteOrders, RawInASubIfdAndExif)
{
    const DngMetadata metadata = read(tiny_dng_with_sub_ifds(), GetParam());
    EXPECT_EQ(metadata.active_area.width, 8);
    EXPECT_EQ(metadata.white_level, 1023);
    const Shot& shot = metadata.shot;
    EXPECT_EQ(shot.exposure_time, 1.0 / 60.0);
    EXPECT_EQ(shot.f_number, 5.6);
    EXPECT_EQ(shot.focal_length, 65.0);
    EXPECT_EQ(shot.iso, 400);
    EXPECT_EQ(shot.date_time_original, "2019:06:06 07:29:51");
    EXPECT_EQ(shot.lens_model, "EF24-105mm f/4L");
}

/// A BigTIFF's directories say the same, with wider counts and offsets.
TEST_P(BothByteOrders, BigTiffIsReadAsClassic)
{
    const Ifd ifd = tiny_dng_with_sub_ifds();
    const DngMetadata classic = read(ifd, GetParam());
    const DngMetadata big = read(ifd, GetParam(), true);
    EXPECT_EQ(big.calibrations[0].camera_from_xyz.m,
              classic.calibrations[0].camera_from_xyz.m);
    EXPECT_EQ(big.as_shot_neutral, classic.as_shot_neutral);
    EXPECT_EQ(big.black_level, classic.black_level);
    EXPECT_EQ(big.shot.exposure_time, 1.0 / 60.0);
    EXPECT_EQ(big.shot.lens_model, "EF24-105mm f/4L");
}

INSTANTIATE_TEST_SUITE_P(DngReader, BothByteOrders, testing::Bool());

/// Tags as a Nexus 5X writes them: D65 first, rationals over 128, calibrated cameras,
/// fractional black, Exif tags in IFD0.
Ifd nexus_5x()
{
    Ifd ifd = tiny_dng();
    ifd.longs(256, { 4080 }).longs(257, { 3028 }).longs(50829, { 2, 48, 3026, 4080 });
    ifd.shorts(50713, { 2, 2 }).rationals(50714, { 5207, 5205, 5185, 5221 }, 100);
    ifd.signed_rationals(50721, { 104, -29, -16, -41, 162, 5, -5, 29, 57 }, 128);
    ifd.signed_rationals(50722, { 129, -37, -28, -72, 209, -6, -8, 27, 80 }, 128);
    ifd.signed_rationals(50723, { 128, 0, 0, 0, 128, 0, 0, 0, 125 }, 128);
    ifd.signed_rationals(50724, { 127, 0, 0, 0, 128, 0, 0, 0, 124 }, 128);
    ifd.signed_rationals(50964, { 74, 28, 21, 20, 108, 0, -2, -37, 145 }, 128);
    ifd.signed_rationals(50965, { 88, 2, 34, 27, 87, 13, 0, -69, 175 }, 128);
    ifd.rationals(50728, { 61, 129, 71 }, 128);
    ifd.shorts(50778, { 21 }).shorts(50779, { 17 });
    ifd.rationals(33434, { 666857 }, 40000000).shorts(34855, { 109 });
    return ifd;
}

TEST(DngReader, FoldsCalibrationInEitherOrderOfLights)
{
    const DngMetadata metadata = read(nexus_5x());
    ASSERT_EQ(metadata.calibrations.size(), 2U);
    const auto& [d65, a] = std::tie(metadata.calibrations[0], metadata.calibrations[1]);
    EXPECT_EQ(d65.light_source, 21);
    EXPECT_EQ(a.light_source, 17);
    EXPECT_DOUBLE_EQ(d65.camera_from_xyz(0, 0), 104.0 / 128.0);
    EXPECT_DOUBLE_EQ(d65.camera_from_xyz(2, 1), 29.0 * 125.0 / 128.0 / 128.0);
    EXPECT_DOUBLE_EQ(a.camera_from_xyz(0, 2), -28.0 * 127.0 / 128.0 / 128.0);
    EXPECT_DOUBLE_EQ(a.camera_from_xyz(1, 1), 209.0 / 128.0);
    EXPECT_DOUBLE_EQ(a.camera_from_xyz(2, 2), 80.0 * 124.0 / 128.0 / 128.0);
    EXPECT_EQ((*d65.xyz_d50_from_camera)(2, 2), 145.0 / 128.0);
    EXPECT_EQ((*a.xyz_d50_from_camera)(0, 0), 88.0 / 128.0);
    EXPECT_FALSE(has_note(metadata.notes, "ForwardMatrix"));
    EXPECT_DOUBLE_EQ((*metadata.as_shot_neutral)[0], 61.0 / 129.0);
    EXPECT_DOUBLE_EQ((*metadata.as_shot_neutral)[2], 71.0 / 129.0);
}

TEST(DngReader, ReadsFractionalBlackActiveAreaAndExifOfIfd0)
{
    const DngMetadata metadata = read(nexus_5x());
    EXPECT_EQ(metadata.active_area.width, 4032);
    EXPECT_EQ(metadata.active_area.height, 3024);
    EXPECT_EQ(metadata.black_level,
              (std::vector<double> { 52.07, 52.05, 51.85, 52.21 }));
    EXPECT_EQ(metadata.shot.iso, 109);
    EXPECT_EQ(metadata.shot.exposure_time, 666857.0 / 40000000.0);
}

TEST(DngReader, CalibrationNeedsTheSameSignatureAsTheProfile)
{
    Ifd ifd = nexus_5x();
    ifd.text(50931, std::string("com.adobe\0", 10));
    const DngMetadata differs = read(ifd);
    EXPECT_EQ(differs.calibrations[0].camera_from_xyz(2, 2), 57.0 / 128.0);
    EXPECT_TRUE(has_note(differs.notes, "CameraCalibration1 does not apply"));
    const DngMetadata same = read(ifd.text(50932, "com.adobe"));
    EXPECT_DOUBLE_EQ(same.calibrations[0].camera_from_xyz(2, 2),
                     57.0 * 125.0 / 128.0 / 128.0);
}

TEST(DngReader, AnalogBalanceScalesTheRowsAndLeavesTheForwardMatrix)
{
    Ifd ifd = nexus_5x();
    const DngMetadata plain = read(ifd);
    const DngMetadata scaled
        = read(ifd.rationals(50727, { 2158672, 1000000, 1414752 }, 1000000));
    expect_near(scaled.calibrations[0].camera_from_xyz,
                diagonal({ 2.158672, 1.0, 1.414752 })
                    * plain.calibrations[0].camera_from_xyz,
                1e-15);
    expect_near(*scaled.calibrations[0].xyz_d50_from_camera,
                *plain.calibrations[0].xyz_d50_from_camera, 0.0);
}

/// Rows that sum to 0.95 1.4 1.1, each over 10000.
TEST(DngReader, ForwardMatrixIsBroughtToD50OrLeftOut)
{
    Ifd ifd = nexus_5x();
    EXPECT_FALSE(has_note(read(ifd).notes, "ForwardMatrix1"));
    ifd.signed_rationals(50964, { 7000, 2000, 500, 3000, 9000, 2000, 200, 1000, 9800 },
                         10000);
    const DngMetadata scaled = read(ifd);
    EXPECT_TRUE(maps_white_to_d50(*scaled.calibrations[0].xyz_d50_from_camera));
    EXPECT_TRUE(has_note(scaled.notes,
                         "ForwardMatrix1 (50964) maps white to XYZ 0.95 1.4 1.1; it "
                         "must be that of D50, 0.9643 1 0.8251"));
    ifd.signed_rationals(50964, { 7000, 2000, 500, 3000, 9000, 2000, 200, 1000, -9800 },
                         10000);
    const DngMetadata without = read(ifd);
    EXPECT_FALSE(without.calibrations[0].xyz_d50_from_camera);
    EXPECT_TRUE(has_note(without.notes, "it is not used"));
}

/// Three values over d are off by 1.5 / d together, and D50 of few decimals by 0.001:
/// rows of 0.9643 1 0.8251 are 123.4 128 105.6 of 128ths, 987.4 1024 844.9 of 1024ths.
TEST(DngReader, ForwardMatrixMayBeRoundedToItsDenominator)
{
    struct {
        std::int32_t denominator;
        std::vector<std::int64_t> values;
        bool is_rounded;
    } const cases[] = {
        { 128, { 88, 2, 35, 27, 87, 13, 0, -69, 174 }, true }, // 125 127 105
        { 128, { 88, 2, 35, 27, 87, 12, 0, -69, 174 }, false }, // 125 126 105
        { 1024, { 700, 200, 89, 230, 700, 96, 0, -500, 1345 }, true }, // 989 1026 845
        { 1024, { 700, 200, 89, 230, 700, 97, 0, -500, 1345 }, false }, // 989 1027 845
        { 10000, { 7000, 2000, 654, 3, 9990, 0, 0, 0, 8240 }, true }, // 9654 9993 8240
        { 10000, { 7000, 2000, 655, 3, 9990, 0, 0, 0, 8240 }, false }, // 9655 9993 8240
        { 1, { 1, 0, 0, 0, 1, 0, 0, 0, 1 }, false },
    };
    for (const auto& [denominator, values, is_rounded] : cases) {
        Ifd ifd = nexus_5x();
        const auto found = read(ifd.signed_rationals(50964, values, denominator));
        const Mat3& forward = *found.calibrations[0].xyz_d50_from_camera;
        EXPECT_EQ(has_note(found.notes, "ForwardMatrix1"), !is_rounded) << denominator;
        EXPECT_EQ(forward(0, 0) == double(values[0]) / denominator, is_rounded);
        EXPECT_TRUE(maps_white_to_d50(forward, denominator));
    }
}

TEST(DngReader, DefaultScaleIsTheShapeOfPixels)
{
    Ifd ifd = tiny_dng();
    EXPECT_FALSE(read(ifd).shot.pixel_aspect);
    EXPECT_EQ(read(ifd.fractions(50718, { { 2, 1 }, { 1, 1 } })).shot.pixel_aspect,
              2.0);
    for (const std::uint64_t denominator : { 0, 1 })
        EXPECT_FALSE(read(ifd.fractions(50718, { { 0, denominator }, { 1, 1 } }))
                         .shot.pixel_aspect);
}

/// Law: with a calibration that mixes channels, the folded ForwardMatrix takes a
/// colour, balanced by its light's neutral, to where the specification's own path takes
/// it.
TEST(DngReader, ForwardMatrixAgreesWithTheSpecificationsPath)
{
    Ifd ifd = nexus_5x();
    ifd.signed_rationals(50723, { 130, 4, -3, 5, 126, 2, -6, 1, 125 }, 128);
    const Calibration d65 = read(ifd).calibrations[0];
    const Mat3 calibration { { 130. / 128, 4. / 128, -3. / 128, 5. / 128, 126. / 128,
                               2. / 128, -6. / 128, 1. / 128, 125. / 128 } };
    const Mat3 forward { { 74. / 128, 28. / 128, 21. / 128, 20. / 128, 108. / 128, 0,
                           -2. / 128, -37. / 128, 145. / 128 } };
    const Vec3 neutral
        = d65.camera_from_xyz * xyz_from_xy(planckian_xy(light_source_temperature(21)));
    const Vec3 camera { 0.3, 0.7, 0.2 };

    const Vec3 reference_neutral = inverse(calibration) * neutral;
    const Mat3 balance = inverse(diagonal(reference_neutral));
    const Vec3 expected = forward * (balance * (inverse(calibration) * camera));
    const Vec3 actual
        = *d65.xyz_d50_from_camera * (inverse(diagonal(neutral)) * camera);
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(actual[i], expected[i], 1e-14);
    EXPECT_GT(std::abs((*d65.xyz_d50_from_camera)(0, 1) - forward(0, 1)), 1e-3);
}

/// Law: the neutral of AsShotWhiteXY leads back to the same chromaticity.
TEST(DngReader, WhiteXyBecomesANeutralThroughTheMatrices)
{
    Ifd ifd = nexus_5x();
    ifd.without(50728).rationals(50729, { 3800, 3767 }, 10000);
    const DngMetadata metadata = read(ifd);
    ASSERT_TRUE(metadata.as_shot_neutral);
    EXPECT_EQ((*metadata.as_shot_neutral)[1], 1.0);
    const auto found
        = xy_from_neutral(profile_from_dng(metadata), *metadata.as_shot_neutral);
    EXPECT_NEAR(found.xy.x, 0.3800, 2e-6); // raw converters round the neutral to 1e-6
    EXPECT_NEAR(found.xy.y, 0.3767, 2e-6);
}

TEST(DngReader, OneMatrixServesAllLightsWhereTheSecondCannot)
{
    Ifd ifd = nexus_5x();
    ASSERT_EQ(read(ifd).calibrations.size(), 2U);
    for (std::uint64_t second : { 0, 255, 21, 11111 }) {
        const DngMetadata metadata = read(ifd.shorts(50779, { second }));
        EXPECT_EQ(metadata.calibrations.size(), 1U) << second;
        EXPECT_TRUE(has_note(metadata.notes, "CalibrationIlluminant1 and 2")) << second;
    }
    const DngMetadata unnamed = read(tiny_dng().without(50778));
    EXPECT_EQ(unnamed.calibrations[0].light_source, 21);
    EXPECT_TRUE(has_note(unnamed.notes, "CalibrationIlluminant1 (50778) is missing"));
    EXPECT_TRUE(has_note(unnamed.notes, "ColorMatrix2 (50722) is missing"));
}

struct BlackCase {
    const char* name;
    std::vector<std::uint64_t> repeat; ///< rows, cols
    std::vector<std::uint64_t> dn;
    std::vector<double> expected;
};

class BlackLevels : public testing::TestWithParam<BlackCase> { };

TEST_P(BlackLevels, AreMeansOverTheSitesOfTheCfa)
{
    Ifd ifd = tiny_dng();
    ifd.shorts(50713, GetParam().repeat).shorts(50714, GetParam().dn);
    EXPECT_EQ(read(ifd).black_level, GetParam().expected);
}

INSTANTIATE_TEST_SUITE_P(
    DngReader, BlackLevels,
    testing::Values(BlackCase { "one", { 1, 1 }, { 64 }, { 64, 64, 64, 64 } },
                    BlackCase { "quad", { 2, 2 }, { 1, 2, 3, 4 }, { 1, 2, 3, 4 } },
                    BlackCase { "row", { 1, 2 }, { 10, 20 }, { 10, 20, 10, 20 } },
                    BlackCase { "column", { 2, 1 }, { 10, 20 }, { 10, 10, 20, 20 } },
                    BlackCase {
                        "tall", { 4, 2 }, { 1, 2, 3, 4, 5, 6, 7, 8 }, { 3, 4, 5, 6 } },
                    BlackCase { "odd", { 3, 1 }, { 0, 30, 60 }, { 30, 30, 30, 30 } }),
    [](const auto& test) { return std::string(test.param.name); });

TEST(DngReader, BlackDeltasCountByTheirMeans)
{
    Ifd ifd = tiny_dng();
    ifd.signed_rationals(50715, { 1, 3, 1, 3, 1, 3, 1, 3 }, 2); // columns
    ifd.signed_rationals(50716, { -1, 0, -2, 0, -3, 0 }, 1); // rows
    const DngMetadata metadata = read(ifd);
    EXPECT_EQ(metadata.black_level, (std::vector<double> { 62.5, 63.5, 64.5, 65.5 }));
    EXPECT_TRUE(has_note(metadata.notes, "BlackLevelDeltaH"));
    EXPECT_TRUE(has_note(metadata.notes, "BlackLevelDeltaV"));
}

TEST(DngReader, LevelsHaveTheSpecificationsDefaults)
{
    Ifd ifd = tiny_dng();
    ifd.shorts(258, { 12 }).without(50714).without(50713).without(50717);
    const DngMetadata metadata = read(ifd);
    EXPECT_EQ(metadata.white_level, 4095);
    EXPECT_EQ(metadata.bits, 12);
    EXPECT_EQ(metadata.black_level, (std::vector<double> { 0, 0, 0, 0 }));
    EXPECT_TRUE(has_note(metadata.notes, "BlackLevel (50714) is missing"));
}

TEST(DngReader, BitsAreThoseThatWhiteNeeds)
{
    const std::pair<std::uint64_t, int> cases[]
        = { { 255, 8 },    { 256, 9 },    { 1023, 10 },  { 1024, 11 },
            { 15000, 14 }, { 16383, 14 }, { 51080, 16 }, { 65535, 16 } };
    for (const auto& [white, bits] : cases)
        EXPECT_EQ(read(tiny_dng().longs(50717, { white })).bits, bits) << white;
}

TEST(DngReader, ReadsEveryBayerPhaseAndXTrans)
{
    const std::pair<const char*, std::vector<std::uint64_t>> phases[]
        = { { "RGGB", { 0, 1, 1, 2 } },
            { "GRBG", { 1, 0, 2, 1 } },
            { "GBRG", { 1, 2, 0, 1 } },
            { "BGGR", { 2, 1, 1, 0 } } };
    for (const auto& [name, colors] : phases)
        EXPECT_EQ(name_of(read(tiny_dng().bytes(33422, colors)).cfa), name);
    Ifd ifd = tiny_dng();
    std::vector<std::uint64_t> x_trans;
    for (char color : std::string("GBGGRGRGRBGBGBGGRGGRGGBGBGBRGRGRGGBG"))
        x_trans.push_back(color == 'R' ? 0 : color == 'G' ? 1 : 2);
    const DngMetadata metadata
        = read(ifd.shorts(33421, { 6, 6 }).bytes(33422, x_trans));
    EXPECT_EQ(name_of(metadata.cfa), "GBGGRGRGRBGBGBGGRGGRGGBGBGBRGRGRGGBG");
    EXPECT_EQ(metadata.black_level, std::vector<double>(36, 64.0));
}

TEST(DngReader, TextIsTrimmedTerminatedOrNotAndAlwaysUtf8)
{
    Ifd ifd = tiny_dng();
    ifd.text(271, "  PENTAX   ").text(272, std::string("Q-S1  \0junk", 11));
    ifd.text(50708, "unterminated").text(315, "Zo\xC3\xAB").text(33432, "\xA9 me\nyou");
    ifd.text(270, "\xED\xA0\x80|\xC0\x80|\xF5|\xE2\x82");
    const DngMetadata metadata = read(ifd);
    EXPECT_EQ(metadata.make, "PENTAX");
    EXPECT_EQ(metadata.model, "Q-S1");
    EXPECT_EQ(metadata.unique_camera_model, "unterminated");
    EXPECT_EQ(metadata.shot.artist, "Zo\xC3\xAB");
    EXPECT_EQ(metadata.shot.copyright, "? me you");
    EXPECT_EQ(metadata.shot.description, "???|??|?|??");
}

TEST(DngReader, NoiseProfileHasOnePairPerPlaneOrOneForAll)
{
    const auto one = read(tiny_dng().doubles(51041, { 1e-4, 2e-7 })).noise_profile;
    ASSERT_EQ(one.size(), 3U);
    for (const NoisePair& pair : one) {
        EXPECT_EQ(pair.scale, 1e-4);
        EXPECT_EQ(pair.offset, 2e-7);
    }
    const auto three
        = read(tiny_dng().doubles(51041, { 1e-4, 2e-7, 3e-4, 4e-7, 5e-4, 6e-7 }))
              .noise_profile;
    ASSERT_EQ(three.size(), 3U);
    EXPECT_EQ(three[1].scale, 3e-4);
    EXPECT_EQ(three[2].offset, 6e-7);
    const DngMetadata silent = read(tiny_dng().doubles(51041, { 0, 0 }));
    EXPECT_TRUE(silent.noise_profile.empty());
    EXPECT_TRUE(has_note(silent.notes, "zeros only"));
}

TEST(DngReader, TagsInTheOtherDirectoryAreFound)
{
    Ifd ifd = tiny_dng_with_sub_ifds();
    ifd.doubles(51041, { 1e-4, 2e-7 });
    EXPECT_EQ(read(ifd).noise_profile.at(0).scale, 1e-4); // in IFD0
    ifd.sub_ifds[1].doubles(51041, { 3e-4, 4e-7 });
    EXPECT_EQ(read(ifd).noise_profile.at(0).scale,
              3e-4); // the raw IFD's has precedence
    ifd.sub_ifds[1].fields[50721] = ifd.fields[50721];
    ifd.without(50721);
    EXPECT_EQ(read(ifd).calibrations.at(0).camera_from_xyz(0, 0), 0.7034);
}

TEST(DngReader, ExifUnknownsAreAbsent)
{
    Ifd ifd = tiny_dng();
    ifd.rationals(33434, { 0 }, 1)
        .rationals(33437, { 0 }, 0)
        .rationals(37386, { 5 }, 0);
    ifd.shorts(34855, { 0 }).text(36867, "    :  :     :  :  ").shorts(274, { 9 });
    const Shot shot = read(ifd).shot;
    EXPECT_FALSE(shot.exposure_time || shot.f_number || shot.focal_length || shot.iso);
    EXPECT_EQ(shot.date_time_original, "");
    EXPECT_EQ(shot.orientation, 1);
}

/// The bounds are those of the shots that are written: 1e-6 to 1e6.
TEST(DngReader, ExifThatNoShotCanHaveIsAbsent)
{
    Ifd ifd = tiny_dng();
    ifd.rationals(33434, { 1 }, 1250000).rationals(37386, { 1000001 }, 1);
    ifd.rationals(33437, { 1 }, 1000000).text(36867, "2019-06-06 07:29:51");
    const Shot shot = read(ifd).shot;
    EXPECT_FALSE(shot.exposure_time || shot.focal_length);
    EXPECT_EQ(shot.f_number, 1e-6);
    EXPECT_EQ(shot.date_time_original, "");
}

TEST(DngReader, IsoAbove16BitsIsReadWhereExifPutsIt)
{
    Ifd ifd = tiny_dng();
    ifd.shorts(34855, { 65535 }).longs(34866, { 102400 });
    EXPECT_EQ(read(ifd).shot.iso, 102400);
}

} // namespace
} // namespace cg2raw::test

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Several DNGs of one camera as one profile, and those that are not of one.
#include "reader/metadata_parts.h"
#include "tiff_builder.h"

#include <gtest/gtest.h>

#include <functional>
#include <sstream>

namespace cg2raw::test {
namespace {

DngMetadata shot(const std::string& name, const std::function<void(Ifd&)>& change = {})
{
    Ifd ifd = tiny_dng();
    if (change)
        change(ifd);
    std::istringstream stream(file_of(ifd));
    return read_dng_stream(stream, name);
}

Ifd& with_noise(Ifd& ifd, std::uint64_t iso, double scale, double offset)
{
    return ifd.shorts(34855, { iso }).doubles(51041, { scale, offset });
}

int count(const std::vector<std::string>& notes, const std::string& words)
{
    int found = 0;
    for (const std::string& note : notes)
        found += note.find(words) != std::string::npos;
    return found;
}

TEST(DngProfiles, MeasureTheDigitalGainOfFilesThatStateBaselineExposure)
{
    const auto brighter = [](double stops) {
        return shot("1.dng", [&](Ifd& ifd) { ifd.doubles(50730, { stops }); });
    };
    EXPECT_FALSE(profile_from_dngs({ shot("1.dng") }, "").profile.digital_gain);
    const auto one = profile_from_dngs({ brighter(1.0), shot("2.dng") }, "").profile;
    ASSERT_TRUE(one.digital_gain);
    EXPECT_EQ(one.digital_gain->mean, 2.0);
    EXPECT_EQ(one.digital_gain->sigma, 0.0);
    const auto two = profile_from_dngs({ brighter(1.0), brighter(0.0) }, "").profile;
    EXPECT_EQ(two.digital_gain->mean, 1.5);
    EXPECT_EQ(two.digital_gain->sigma, 0.5);
}

TEST(DngProfiles, KeepAllNeutralsAndOneRowOfNoisePerIso)
{
    const std::vector<DngMetadata> files {
        shot("x/1.dng", [](Ifd& ifd) { with_noise(ifd, 800, 8e-4, 8e-7); }),
        shot("x/2.dng",
             [](Ifd& ifd) {
                 with_noise(ifd, 100, 1e-4, 1e-7).rationals(50728, { 6, 10, 5 }, 10);
             }),
        shot("x/3.dng",
             [](Ifd& ifd) {
                 with_noise(ifd, 800, 8e-4, 10e-7).rationals(50728, { 4, 10, 8 }, 10);
             }),
        shot("x/4.dng", [](Ifd& ifd) { ifd.without(50728); }),
    };
    const auto [profile, notes] = profile_from_dngs(files, "my-camera.2");
    EXPECT_EQ(profile.id, "my-camera.2");
    EXPECT_EQ(profile.illuminants.neutrals,
              (std::vector<std::array<double, 2>> {
                  { 0.522449, 0.571429 }, { 0.6, 0.5 }, { 0.4, 0.8 } }));
    EXPECT_EQ(profile.illuminants.hull.size(), 3U);
    ASSERT_EQ(profile.noise.size(), 2U);
    EXPECT_EQ(profile.noise[0].iso, 100);
    EXPECT_EQ(profile.noise[0].beta1, std::vector<double>(4, 1e-4));
    EXPECT_EQ(profile.noise[1].iso, 800);
    EXPECT_EQ(profile.noise[1].beta1, std::vector<double>(4, 8e-4));
    EXPECT_NEAR(profile.noise[1].beta2[3], 9e-7, 1e-20);
    EXPECT_EQ(count(notes, "at ISO 800 differs by up to 22.22 %"), 1);
    EXPECT_EQ(count(notes, "names no illuminant (in 1 of 4 files)"), 1);
    EXPECT_EQ(count(notes, "ColorMatrix2 (50722) is missing"), 1); // of four files
    EXPECT_EQ(count(notes, "fewer than 3 distinct neutrals"), 0);
    EXPECT_EQ(profile.sources[0].second, "4 DNGs, 1.dng to 4.dng: raw IFD");
    const std::string json = to_json(profile);
    EXPECT_EQ(to_json(parse_profile(json, "profile")), json);
}

TEST(DngProfiles, SayWhatTheirFilesLackAndWhatItCosts)
{
    const auto notes
        = profile_from_dngs(
              { shot("1.dng"), shot("2.dng", [](Ifd& ifd) { ifd.without(50728); }) })
              .notes;
    EXPECT_EQ(count(notes, "sample:n has nothing to draw from"), 1);
    EXPECT_EQ(count(notes, "noise cannot be simulated"), 1);
    const auto two = [](Ifd& ifd) {
        with_noise(ifd, 200, 1e-4, 1e-7).shorts(50779, { 17 });
        ifd.fields[50722] = ifd.fields[50721];
    };
    const auto others = profile_from_dngs({ shot("1.dng", two) }).notes;
    EXPECT_EQ(count(others, "walks along the Planckian locus"), 1);
    EXPECT_EQ(count(others, "noise is known at ISO 200 alone"), 1);
}

TEST(DngProfiles, TakeTheMeanOfBlackLevelsThatAreClose)
{
    const auto black = [](std::int64_t hundredths) {
        return shot(std::to_string(hundredths) + ".dng", [=](Ifd& ifd) {
            ifd.rationals(50714, { hundredths }, 100).shorts(50717, { 16383 });
        });
    };
    const auto one = profile_from_dngs({ black(5207), black(5207), black(5207) });
    EXPECT_EQ(one.profile.black_level, std::vector<double>(4, 52.07)); // exactly
    EXPECT_EQ(count(one.notes, "BlackLevel"), 0);
    const auto made = profile_from_dngs({ black(5200), black(5300), black(8400) });
    EXPECT_EQ(made.profile.black_level, std::vector<double>(4, 63.0));
    EXPECT_EQ(count(made.notes, "BlackLevel (50714) differs by up to 32 DN"), 1);
    try {
        profile_from_dngs({ black(5200), black(5300), black(8500) });
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what())
                      .find("BlackLevel (50714) is 52 DN in 5200.dng and 85 DN in "
                            "8500.dng; it may differ by 32.77 DN"),
                  std::string::npos)
            << error.what();
    }
}

TEST(DngProfiles, TakeMatricesThatDifferByRoundingInEitherOrder)
{
    const auto two = [](bool daylight_first) {
        return shot("a.dng", [=](Ifd& ifd) {
            ifd.signed_rationals(
                50722, { 7035, -805, -1014, -4421, 12564, 2059, -851, 1994, 5758 },
                10000);
            ifd.shorts(50778, { 21 }).shorts(50779, { 17 });
            if (!daylight_first) {
                std::swap(ifd.fields[50721], ifd.fields[50722]);
                std::swap(ifd.fields[50778], ifd.fields[50779]);
            }
        });
    };
    const auto profile = profile_from_dngs({ two(true), two(false) }).profile;
    EXPECT_EQ(profile.calibrations[0].light_source, 21);
    EXPECT_EQ(profile.calibrations[1].light_source, 17);
}

struct Difference {
    const char* name;
    const char* message;
    std::function<void(Ifd&)> change;
};

class NotOneCamera : public testing::TestWithParam<Difference> { };

TEST_P(NotOneCamera, IsAnErrorThatNamesTheFiles)
{
    const auto& other = GetParam().change;
    try {
        profile_from_dngs({ shot("1.dng"), shot("2.dng", other), shot("3.dng"),
                            shot("4.dng", other) });
        ADD_FAILURE() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).rfind("1.dng: ", 0), 0U) << error.what();
        EXPECT_NE(std::string(error.what()).find(GetParam().message), std::string::npos)
            << error.what();
    }
}

const Difference differences[] = {
    { "Model",
      "(Maker Model 1 (Make Maker, Model Model 1): 1.dng, 3.dng; Maker Model 1 (Make "
      "Maker, Model Model 2): 2.dng, 4.dng): make a profile of each",
      [](Ifd& ifd) { ifd.text(272, "Model 2"); } },
    { "UniqueModel", "Other (Make Maker, Model Model 1): 2.dng, 4.dng",
      [](Ifd& ifd) { ifd.text(50708, "Other"); } },
    { "Crop", "active area is not the same in all files (8 x 6: 1.dng, 3.dng; 8 x 4: ",
      [](Ifd& ifd) {
          ifd.longs(50829, { 0, 0, 4, 8 });
      } },
    { "Cfa",
      "CFAPattern (33422) is not the same in all files (RGGB: 1.dng, 3.dng; BGGR",
      [](Ifd& ifd) {
          ifd.bytes(33422, { 2, 1, 1, 0 });
      } },
    { "White",
      "WhiteLevel (50717) is not the same in all files (1023: 1.dng, 3.dng; 10",
      [](Ifd& ifd) { ifd.shorts(50717, { 1000 }); } },
    { "Firmware",
      "ColorMatrix for D65 (by up to 0.0002, CameraCalibration folded in) is not the "
      "same in 2.dng, 4.dng",
      [](Ifd& ifd) {
          ifd.signed_rationals(
              50721, { 7036, -804, -1014, -4420, 12564, 2058, -851, 1994, 5758 },
              10000);
      } },
    { "Light", "CalibrationIlluminant (D65 and D50) is not the same in 2.dng, 4.dng",
      [](Ifd& ifd) { ifd.shorts(50778, { 23 }); } },
    { "Matrices", "the number of matrices is not the same in 2.dng, 4.dng",
      [](Ifd& ifd) {
          ifd.fields[50722] = ifd.fields[50721];
          ifd.shorts(50779, { 17 });
      } },
    { "Forward", "ForwardMatrix for D65 is not the same in 2.dng, 4.dng",
      [](Ifd& ifd) {
          ifd.signed_rationals(50964, { 7, 2, 1, 2, 8, 0, 0, 1, 7 }, 10);
      } },
};

INSTANTIATE_TEST_SUITE_P(DngProfiles, NotOneCamera, testing::ValuesIn(differences),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(DngProfiles, NeedAFileAndALegalId)
{
    EXPECT_THROW(profile_from_dngs({}), Error);
    EXPECT_THROW(profile_from_dngs({ shot("1.dng") }, "My Camera"), Error);
    EXPECT_EQ(profile_from_dngs({ shot("1.dng") }).profile.id, "maker-model-1");
}

} // namespace
} // namespace cg2raw::test

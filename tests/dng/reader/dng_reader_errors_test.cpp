// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Each thing that can be wrong with a reference DNG, and the message that says
/// so.
#include "reader/metadata_parts.h"
#include "tiff_builder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <sstream>

namespace cg2raw::test {
namespace {

std::string error_of(const std::string& bytes)
{
    std::istringstream stream(bytes);
    try {
        read_dng_stream(stream, "test.dng");
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

struct Case {
    const char* name;
    const char* message; ///< part of it
    std::function<void(Ifd&)> spoil;
};

class DngReaderErrors : public testing::TestWithParam<Case> { };

TEST_P(DngReaderErrors, NameFileTagAndBound)
{
    Ifd ifd = tiny_dng();
    GetParam().spoil(ifd);
    const std::string message = error_of(file_of(ifd));
    EXPECT_EQ(message.rfind("test.dng: ", 0), 0U) << message;
    EXPECT_NE(message.find(GetParam().message), std::string::npos) << message;
}

const double nan = std::nan("");
const std::vector<std::int64_t> nine_ones(9, 1);

const Case structure_cases[] = {
    { "NoDngVersion", "DNGVersion (50706) is missing: the file is no DNG",
      [](Ifd& ifd) { ifd.without(50706); } },
    { "FutureVersion", "DNGBackwardVersion (50707) is 1.8; versions up to 1.7 are read",
      [](Ifd& ifd) {
          ifd.bytes(50707, { 1, 8, 0, 0 });
      } },
    { "LinearRaw", "is LinearRaw (34892), demosaicked as ProRAW is, and does not",
      [](Ifd& ifd) { ifd.shorts(262, { 34892 }).shorts(277, { 3 }); } },
    { "OnlyAPreview", "is CFA (32803) in no full-resolution image",
      [](Ifd& ifd) { ifd.longs(254, { 1 }); } },
    { "ManySubIfds", "SubIFDs (330) has 33 values; allowed: 1 to 32",
      [](Ifd& ifd) {
          ifd.shorts(262, { 2 }).longs(330, std::vector<std::uint64_t>(33, 8));
      } },
    { "SubIfdOutside", "SubIFD at byte 4294967295 reaches beyond the file's",
      [](Ifd& ifd) { ifd.shorts(262, { 2 }).longs(330, { 0xFFFFFFFF }); } },
    { "ThreeSamples", "SamplesPerPixel (277) is 3; allowed: 1",
      [](Ifd& ifd) { ifd.shorts(277, { 3 }); } },
    { "FloatSamples", "SampleFormat (339) is 3, floating point",
      [](Ifd& ifd) { ifd.shorts(339, { 3 }); } },
    { "Nameless", "UniqueCameraModel (50708) and Model (272) are missing or empty",
      [](Ifd& ifd) { ifd.without(50708).text(272, "  "); } },
    { "NameOfNumbers", "Model (272) has type 3; allowed: ASCII (2)",
      [](Ifd& ifd) { ifd.shorts(272, { 1 }); } },
};

const Case level_cases[] = {
    { "WidthIsText", "ImageWidth (256) has type 2; allowed: a type of integers",
      [](Ifd& ifd) { ifd.text(256, "8"); } },
    { "WideImage", "ImageWidth (256) is 65536; allowed: 2 to 65535",
      [](Ifd& ifd) { ifd.longs(256, { 65536 }); } },
    { "AreaBeyondImage", "ActiveArea (50829) is 0 0 6 9 (top, left, bottom, right)",
      [](Ifd& ifd) {
          ifd.longs(50829, { 0, 0, 6, 9 });
      } },
    { "AreaInsideOut", "it must hold 2 x 2 pixels or more",
      [](Ifd& ifd) {
          ifd.longs(50829, { 4, 0, 2, 8 });
      } },
    { "NoCfa", "CFAPattern (33422) is missing", [](Ifd& ifd) { ifd.without(33422); } },
    { "CyanCfa", "CFAPattern (33422) has colour 3; allowed: 0 (red)",
      [](Ifd& ifd) {
          ifd.bytes(33422, { 0, 1, 3, 2 });
      } },
    { "NoBlueInCfa", "CFAPattern (33422) lacks colour 2",
      [](Ifd& ifd) {
          ifd.bytes(33422, { 0, 1, 1, 0 });
      } },
    { "ShortCfa", "CFAPattern (33422) has 3 values; allowed: 4",
      [](Ifd& ifd) {
          ifd.bytes(33422, { 0, 1, 2 });
      } },
    { "WideCfa", "CFARepeatPatternDim (33421) is 7; allowed: 1 to 6",
      [](Ifd& ifd) {
          ifd.shorts(33421, { 7, 2 });
      } },
    { "FourPlanes", "CFAPlaneColor (50710) is not 0 1 2",
      [](Ifd& ifd) {
          ifd.bytes(50710, { 0, 1, 2, 3 });
      } },
    { "Staggered", "CFALayout (50711) is not 1",
      [](Ifd& ifd) { ifd.shorts(50711, { 2 }); } },
    { "BlackAboveWhite",
      "BlackLevel (50714) is 1023 DN at CFA site 0, 0; it must be at",
      [](Ifd& ifd) { ifd.shorts(50714, { 1023 }); } },
    { "BlackOverZero", "BlackLevel (50714) holds a value that is no finite number",
      [](Ifd& ifd) { ifd.rationals(50714, { 64 }, 0); } },
    { "BlackIsNan", "BlackLevel (50714) holds a value that is no finite number",
      [](Ifd& ifd) { ifd.doubles(50714, { nan }); } },
    { "BlackCount", "BlackLevel (50714) has 1 values; allowed: 4",
      [](Ifd& ifd) {
          ifd.shorts(50713, { 2, 2 });
      } },
    { "WideBlack", "BlackLevelRepeatDim (50713) is 9; allowed: 1 to 8",
      [](Ifd& ifd) {
          ifd.shorts(50713, { 9, 1 });
      } },
    { "NegativeBlack", "BlackLevel (50714) is -1 DN",
      [](Ifd& ifd) { ifd.signed_rationals(50714, { -1 }, 1); } },
    { "DeltaCount", "BlackLevelDeltaH (50715) has 7 values; allowed: 8",
      [](Ifd& ifd) {
          ifd.signed_rationals(50715, { 0, 0, 0, 0, 0, 0, 0 }, 1);
      } },
    { "WhiteOf17Bits", "WhiteLevel (50717) is 65536; allowed: 1 to 65535",
      [](Ifd& ifd) { ifd.longs(50717, { 65536 }); } },
};

const Case color_cases[] = {
    { "NoMatrix", "ColorMatrix1 (50721) is missing; it is required",
      [](Ifd& ifd) { ifd.without(50721); } },
    { "ShortMatrix", "ColorMatrix1 (50721) has 8 values; allowed: 9",
      [](Ifd& ifd) {
          ifd.signed_rationals(50721, { 1, 2, 3, 4, 5, 6, 7, 8 }, 1);
      } },
    { "SingularMatrix", "ColorMatrix1 (50721) is singular",
      [](Ifd& ifd) { ifd.signed_rationals(50721, nine_ones, 1); } },
    { "MatrixOverZero", "ColorMatrix1 (50721) holds a value that is no finite number",
      [](Ifd& ifd) { ifd.signed_rationals(50721, nine_ones, 0); } },
    { "MatrixIsText",
      "ColorMatrix1 (50721) holds a value that is no finite number (type 2",
      [](Ifd& ifd) { ifd.text(50721, "123456789"); } },
    { "HugeMatrix", "ColorMatrix1 (50721) has an entry beyond +-1000",
      [](Ifd& ifd) {
          ifd.signed_rationals(50721, { 1001, 0, 0, 0, 1, 0, 0, 0, 1 }, 1);
      } },
    { "BlindChannel", "ColorMatrix1 (50721) maps white to a channel of 0 or below",
      [](Ifd& ifd) {
          ifd.signed_rationals(50721, { -1, 0, 0, 0, 1, 0, 0, 0, 1 }, 1);
      } },
    { "BalanceOfZero", "AnalogBalance (50727) has a gain outside 0.001 to 1000",
      [](Ifd& ifd) {
          ifd.rationals(50727, { 0, 1, 1 }, 1);
      } },
    { "SingularCalibration", "CameraCalibration1 (50723) is singular",
      [](Ifd& ifd) { ifd.signed_rationals(50723, nine_ones, 1); } },
    { "NeutralWithoutGreen", "AsShotNeutral (50728) gives the neutral 1 0 1",
      [](Ifd& ifd) {
          ifd.rationals(50728, { 1, 0, 1 }, 1);
      } },
    { "DarkNeutral", "AsShotNeutral (50728) gives the neutral 0 1 1; R/G and B/G must",
      [](Ifd& ifd) {
          ifd.rationals(50728, { 0, 1, 1 }, 1);
      } },
    { "WhiteOffTheDiagram", "AsShotWhiteXY (50729) is no chromaticity",
      [](Ifd& ifd) {
          ifd.without(50728).rationals(50729, { 1, 1 }, 2);
      } },
    { "NoiseIsNan", "NoiseProfile (51041) holds a value that is no finite number",
      [](Ifd& ifd) {
          ifd.doubles(51041, { nan, 0 });
      } },
    { "NegativeNoise", "NoiseProfile (51041) has a value outside 0 to 1",
      [](Ifd& ifd) {
          ifd.doubles(51041, { -1e-4, 1e-7 });
      } },
    { "NoiseOfFour", "NoiseProfile (51041) has 4 values; allowed: 2 (all planes) or 6",
      [](Ifd& ifd) {
          ifd.doubles(51041, { 1e-4, 1e-7, 1e-4, 1e-7 });
      } },
};

std::string case_name(const testing::TestParamInfo<Case>& info)
{
    return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(Structure, DngReaderErrors, testing::ValuesIn(structure_cases),
                         case_name);
INSTANTIATE_TEST_SUITE_P(Levels, DngReaderErrors, testing::ValuesIn(level_cases),
                         case_name);
INSTANTIATE_TEST_SUITE_P(Color, DngReaderErrors, testing::ValuesIn(color_cases),
                         case_name);

TEST(DngReaderErrors, OfFilesThatAreNoTiff)
{
    EXPECT_EQ(error_of("").rfind("test.dng: has 0 bytes; a DNG has at least 8", 0), 0U);
    EXPECT_NE(error_of("\x89PNG\r\n\x1A\n0000").find("does not start with II or MM"),
              std::string::npos);
    EXPECT_NE(error_of(std::string("II\x2B\0\x08\0\0\0", 8)).find("needs 8 bytes at"),
              std::string::npos);
    EXPECT_NE(
        error_of(std::string("II\x55\0\x08\0\0\0", 8)).find("has TIFF version 85"),
        std::string::npos);
    EXPECT_NE(error_of(std::string("II\x2A\0\xFF\xFF\xFF\xFF", 8))
                  .find("IFD0 at byte 4294967295 reaches beyond the file's 8 bytes"),
              std::string::npos);
}

TEST(DngReaderErrors, OfPathsThatAreNoFile)
{
    for (const char* path : { "tests", "/dev/null", "missing/reference.dng" })
        try {
            read_dng_metadata(path);
            ADD_FAILURE() << path;
        } catch (const Error& error) {
            EXPECT_NE(
                std::string(error.what()).find(": is no file; the reference must be"),
                std::string::npos);
        }
}

} // namespace
} // namespace cg2raw::test

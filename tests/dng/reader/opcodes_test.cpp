// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file GainMaps as they are read, refused, and turned into lens_shading.
#include "effects/lens_shading.h"

#include "opcode_builder.h"
#include "reader_test.h"

#include <gtest/gtest.h>

#include <cmath>
namespace cg2raw::test {
namespace {

Ifd with_list2(const std::vector<TestOpcode>& opcodes)
{
    return tiny_dng().bytes(51009, opcode_list(opcodes));
}

TEST(DngOpcodes, AreBigEndianInFilesOfEitherOrder)
{
    OpcodeBuilder map { 3, 4, [](double v, double h) { return 1 + v + 10 * h; } };
    map.area = { 1, 0, 6, 8 };
    map.row_pitch = map.col_pitch = 2;
    for (bool big_endian : { false, true }) {
        const auto maps = read(with_list2({ map.gain_map() }), big_endian).gain_maps;
        ASSERT_EQ(maps.size(), 1U);
        EXPECT_EQ(maps[0].sites, (std::vector<int> { 2 })); // second row, first column
        EXPECT_EQ(maps[0].top, 1);
        EXPECT_EQ(maps[0].right, 8);
        EXPECT_EQ(maps[0].spacing_v, 0.5);
        EXPECT_EQ(maps[0].map.rows, 3);
        EXPECT_EQ(maps[0].map.cols, 4);
        EXPECT_EQ(maps[0].map.gains[5], float(1.5 + 10.0 / 3.0));
    }
}

TEST(DngOpcodes, MapsSayWhichSitesTheyCover)
{
    OpcodeBuilder map { 2, 2 };
    EXPECT_EQ(read(with_list2({ map.gain_map() })).gain_maps[0].sites,
              (std::vector<int> { 0, 1, 2, 3 }));
    map.col_pitch = 2;
    map.area = { 0, 1, 600, 800 }; // what is beyond the image is nothing
    const DngMetadata metadata = read(with_list2({ map.gain_map() }));
    EXPECT_EQ(metadata.gain_maps[0].sites, (std::vector<int> { 1, 3 }));
    EXPECT_EQ(metadata.gain_maps[0].bottom, 6);
}

TEST(DngOpcodes, OfAMapOfSeveralPlanesTheFirstCounts)
{
    OpcodeBuilder map { 2, 3, [](double v, double h) { return 1 + v + h; } };
    map.map_planes = 3;
    const auto gains = read(with_list2({ map.gain_map() })).gain_maps.at(0).map.gains;
    EXPECT_EQ(gains, (std::vector<float> { 1, 1.5, 2, 2, 2.5, 3 }));
    map.plane = 1; // a mosaic has no second plane
    EXPECT_TRUE(read(with_list2({ map.gain_map() })).gain_maps.empty());
}

TEST(DngOpcodes, OthersAreNamedInANote)
{
    Ifd ifd = with_list2({ { 8, 0, { 1, 2 } }, { 77, 1, {} }, { 8, 0, {} } });
    ifd.bytes(51022, opcode_list({ { 3, 1, {} }, OpcodeBuilder { 2, 2 }.gain_map() }));
    ifd.bytes(51008, { 0, 0, 0, 1, 0, 0 });
    const DngMetadata metadata = read(ifd);
    EXPECT_TRUE(metadata.gain_maps.empty());
    EXPECT_TRUE(has_note(metadata.notes,
                         "OpcodeList2 (51009) has MapPolynomial (8), opcode (77), "
                         "optional: what"));
    EXPECT_TRUE(has_note(metadata.notes,
                         "OpcodeList3 (51022) has FixVignetteRadial (3), optional, "
                         "GainMap (9), optional: what"));
    EXPECT_TRUE(has_note(metadata.notes, "OpcodeList1 (51008) is damaged"));
}

struct Damage {
    const char* name;
    const char* message;
    std::function<void(OpcodeBuilder&)> build;
    std::function<void(std::vector<std::uint64_t>&)> spoil;
};

class DamagedGainMaps : public testing::TestWithParam<Damage> { };

TEST_P(DamagedGainMaps, AreErrorsThatNameTheOpcode)
{
    OpcodeBuilder map { 2, 3 };
    if (GetParam().build)
        GetParam().build(map);
    auto bytes = opcode_list({ { 1, 1, {} }, map.gain_map() });
    if (GetParam().spoil)
        GetParam().spoil(bytes);
    try {
        read(tiny_dng().bytes(51009, bytes));
        ADD_FAILURE() << "no error";
    } catch (const Error& error) {
        const std::string message = error.what();
        EXPECT_EQ(message.rfind("test.dng: OpcodeList2 (51009) ", 0), 0U) << message;
        EXPECT_NE(message.find(GetParam().message), std::string::npos) << message;
    }
}

// The list: count (4), an empty opcode (16), the map's header (16), its parameters.
constexpr std::size_t size_field = 4 + 16 + 12;
const double nan = std::nan("");

const Damage damages[] = {
    { "NoBytes",
      "has 3 values; allowed: 4 to",
      {},
      [](auto& bytes) { bytes.resize(3); } },
    { "ManyOpcodes",
      "claims 4294967295 opcodes, but has room for",
      {},
      [](auto& bytes) { bytes[0] = bytes[1] = bytes[2] = bytes[3] = 255; } },
    { "LongOpcode",
      "opcode 2 of 2, GainMap (9): claims 16777316 bytes where 100",
      {},
      [](auto& bytes) { bytes[size_field] = 1; } },
    { "Truncated",
      "opcode 2 of 2, GainMap (9): claims 100 bytes where 99 are left",
      {},
      [](auto& bytes) { bytes.pop_back(); } },
    { "ShortMap",
      "opcode 2 of 2, GainMap (9): has 75 bytes; a map has 76",
      {},
      [](auto& bytes) { bytes[size_field + 3] = 75; } },
    { "FewGains",
      "2 x 3 points of 1 planes need 6 gains, but it has 5",
      {},
      [](auto& bytes) { bytes[size_field + 3] -= 4; } },
    { "HugeMap",
      "65535 x 65535 points of 65535 planes need 281462092005375 gains",
      {},
      [](auto& bytes) {
          for (std::size_t at : { 32, 36, 72 })
              bytes[size_field + 4 + at + 2] = bytes[size_field + 4 + at + 3] = 255;
      } },
    { "NoPoints",
      "MapPointsV 0 must be 1 to 65535",
      {},
      [](auto& bytes) { bytes[size_field + 4 + 32 + 3] = 0; } },
    { "NoPitch",
      "RowPitch 0 must be 1 to 65535",
      [](auto& map) { map.row_pitch = 0; },
      {} },
    { "NoPlanes",
      "Planes 0 must be 1 to 65535",
      [](auto& map) { map.planes = 0; },
      {} },
    { "EmptyArea",
      "its area covers no pixel of the 8 x 6 active area",
      [](auto& map) {
          map.area = { 6, 0, 9, 8 };
      },
      {} },
    { "SpacingIsNan",
      "MapSpacingV is not within its bounds, above 0 to 10",
      [](auto& map) { map.spacing_v = nan; },
      {} },
    { "NoSpacing",
      "MapSpacingH is not within its bounds",
      [](auto& map) { map.spacing_h = 0.0; },
      {} },
    { "FarOrigin",
      "MapOriginH is not within its bounds, -10 to 10",
      [](auto& map) { map.origin_h = 11.0; },
      {} },
    { "GainOfZero",
      "gain 0 is not within its bounds, above 0 to 1000000",
      [](auto& map) { map.gain = [](double, double) { return 0.0; }; },
      {} },
    { "GainIsNan",
      "gain 4 is not within its bounds",
      [](auto& map) {
          map.gain = [](double v, double h) { return v == 1 && h == 0.5 ? nan : 1.0; };
      },
      {} },
};

INSTANTIATE_TEST_SUITE_P(DngOpcodes, DamagedGainMaps, testing::ValuesIn(damages),
                         [](const auto& test) { return std::string(test.param.name); });

/// What lens_shading_at() gives at a place of the tiny image, 8 x 6.
double shading_at(const Values& values, double v, double h)
{
    return lens_shading_at(values, (h - 0.5) * 8 / 5.0, (v - 0.5) * 6 / 5.0);
}

const Values planted { -0.3, 0.1, -0.05, 0.02, -0.04, 0.03, -0.01 };

OpcodeBuilder shaded(const Values& values, double scale = 1.0)
{
    return { 9, 11,
             [=](double v, double h) { return scale / shading_at(values, v, h); } };
}

void expect_planted(const SensorProfile& profile, double tolerance)
{
    ASSERT_EQ(profile.effects.size(), 1U);
    const Effect& lens_shading = effect("lens_shading");
    const Values found = values_of(lens_shading, profile.effects[0].parameters,
                                   profile.cfa, "profile");
    for (std::size_t i = 0; i < planted.size(); ++i)
        EXPECT_NEAR(found[i], planted[i], tolerance) << i;
}

TEST(DngLensShading, PlantedParametersComeBackWhateverTheScale)
{
    for (double scale : { 1.0, 1.25 })
        expect_planted(
            profile_from_dng(read(with_list2({ shaded(planted, scale).gain_map() }))),
            1e-6); // gains are float32
}

TEST(DngLensShading, IsTheProductOfMapsAndTheMeanOfSites)
{
    OpcodeBuilder red = shaded(planted, 1.0), others = shaded(planted, 1.0);
    const auto undone = red.gain;
    // 1 / gain of the four sites: 1.06, 0.98, 0.98, 0.98 of the planted; their mean
    // is 1.
    red.gain = [=](double v, double h) { return undone(v, h) / 1.06 * 0.98; };
    red.row_pitch = red.col_pitch = 2;
    red.area = { 0, 0, 5, 7 }; // its own pixels end before the frame
    others.gain = [](double, double) { return 1 / 0.98; };
    OpcodeBuilder rest = shaded(planted, 1.0);
    std::vector<TestOpcode> maps { others.gain_map(), red.gain_map() };
    for (std::vector<std::uint32_t> area : { std::vector<std::uint32_t> { 0, 1, 5, 8 },
                                             { 1, 0, 6, 7 },
                                             { 1, 1, 6, 8 } }) {
        rest.area = area;
        rest.row_pitch = rest.col_pitch = 2;
        maps.push_back(rest.gain_map());
    }
    const ProfileOfDngs made = profile_from_dngs({ read(with_list2(maps)) });
    expect_planted(made.profile, 1e-6);
    EXPECT_TRUE(has_note(made.notes, "GainMaps of the CFA's sites differ by 3.464 %"));
}

TEST(DngLensShading, PointsWhoseGainRestoresNothingAreLeftOut)
{
    OpcodeBuilder map = shaded(planted);
    map.gain = [undone = map.gain](double v, double h) {
        return v + h == 0.0 ? 1000.0 : undone(v, h);
    };
    expect_planted(profile_from_dng(read(with_list2({ map.gain_map() }))), 1e-6);
}

TEST(DngLensShading, WhatTheEffectCannotBeIsNotedAndLeftOut)
{
    const auto made = [](OpcodeBuilder map) {
        return profile_from_dngs({ read(with_list2({ map.gain_map() })) });
    };
    const ProfileOfDngs steep = made({ 9, 9, [](double v, double h) {
                                          const double x = h - 0.5, y = v - 0.5;
                                          return 1 + 60 * (x * x + y * y);
                                      } });
    EXPECT_TRUE(steep.profile.effects.empty());
    EXPECT_TRUE(has_note(steep.notes, "GainMaps would need r"));
    const ProfileOfDngs coarse
        = made({ 2, 2, [](double v, double h) { return 1 + v + h; } });
    EXPECT_TRUE(coarse.profile.effects.empty());
    EXPECT_TRUE(has_note(coarse.notes, "GainMaps have too few points"));
    EXPECT_TRUE(made({ 9, 9 }).profile.effects.empty()); // all 1: no shading
    const ProfileOfDngs wavy
        = made({ 17, 17, [](double v, double) { return 1 + 0.1 * std::cos(12 * v); } });
    EXPECT_EQ(wavy.profile.effects.size(), 1U);
    EXPECT_TRUE(has_note(wavy.notes, "frames are so much too bright or dark there"));
}

TEST(DngLensShading, OfSeveralFilesIsTheirMean)
{
    const auto file = [](double red) {
        Values values = planted;
        values[0] += red;
        return read(with_list2({ shaded(values).gain_map() }));
    };
    DngMetadata first = file(-0.05), second = file(0.05);
    const DngMetadata none = read(tiny_dng());
    const ProfileOfDngs made = profile_from_dngs({ first, none, second });
    expect_planted(made.profile, 1e-6);
    EXPECT_TRUE(
        has_note(made.notes, "GainMap (OpcodeList2, 51009) is in 2 of 3 files"));
    EXPECT_TRUE(has_note(made.notes, "GainMaps of the files differ by"));
    EXPECT_FALSE(has_note(made.notes, "differ in lens"));
    second.shot.f_number = 5.6;
    EXPECT_TRUE(has_note(profile_from_dngs({ first, second }).notes, "differ in lens"));
}

} // namespace
} // namespace cg2raw::test

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "writer/tags.h"

#include "writer_fixture.h"

#include <cmath>
#include <map>

namespace cg2raw {
namespace {

using namespace cg2raw::testing;

/// What a real exposure says: 1/125 s at f/2.8, 35 mm.
Shot full_shot()
{
    Shot shot;
    shot.exposure_time = 0.008;
    shot.f_number = 2.8;
    shot.focal_length = 35.0;
    shot.iso = 400;
    shot.date_time_original = "2024:05:06 07:08:09";
    shot.artist = "Artist";
    shot.copyright = "Copyright";
    shot.description = "Description";
    shot.lens_model = "Lens";
    shot.orientation = 6;
    return shot;
}

std::map<std::uint32_t, TagValue> by_number(const Tags& tags)
{
    std::map<std::uint32_t, TagValue> map;
    for (const Tag& tag : tags)
        EXPECT_TRUE(map.emplace(tag.number, tag.value).second)
            << tag.number << " twice";
    return map;
}

double fraction(const TagValue& value)
{
    const Rational rational = std::get<std::vector<Rational>>(value).at(0);
    return double(rational.numerator) / rational.denominator;
}

TEST(DngTags, ExifHoldsTheExposure)
{
    auto exif = by_number(exif_tags(full_shot()));
    const auto& time = std::get<std::vector<Rational>>(exif[33434]);
    EXPECT_EQ(time.at(0).numerator, 1U);
    EXPECT_EQ(time.at(0).denominator, 125U);
    EXPECT_EQ(fraction(exif[33437]), 2.8);
    EXPECT_EQ(fraction(exif[37386]), 35.0);
    EXPECT_EQ(std::get<std::vector<std::uint16_t>>(exif[34855]).at(0), 400);
    EXPECT_EQ(std::get<std::string>(exif[36867]), "2024:05:06 07:08:09");
    EXPECT_EQ(std::get<std::string>(exif[42036]), "Lens");
}

TEST(DngTags, ExposureTimesOfAllLengths)
{
    for (const double seconds :
         { 1.0 / 32000, 1.0 / 60, 0.3, 0.4, 1.3, 30.0, 3600.0, 1e5 }) {
        Shot shot;
        shot.exposure_time = seconds;
        auto exif = by_number(exif_tags(shot));
        EXPECT_NEAR(fraction(exif[33434]) / seconds, 1.0, 1e-6);
    }
}

TEST(DngTags, IsoBeyondExifsSixteenBits)
{
    Shot shot;
    shot.iso = 102400;
    auto exif = by_number(exif_tags(shot));
    EXPECT_EQ(std::get<std::vector<std::uint16_t>>(exif[34855]).at(0), 65535);
    EXPECT_EQ(std::get<std::vector<std::uint16_t>>(exif[34864]).at(0), 3);
    EXPECT_EQ(std::get<std::vector<std::uint32_t>>(exif[34867]).at(0), 102400U);
}

TEST(DngTags, UnknownFieldsAreAbsent)
{
    EXPECT_EQ(exif_tags({}).size(), 1U); // ExifVersion
    const auto tags = by_number(camera_tags(description_of({ 64, 48 }), {}));
    for (const std::uint32_t text : { 270U, 306U, 315U, 33432U })
        EXPECT_EQ(tags.count(text), 0U) << text;
}

TEST(DngTags, TextsStandInIfd0)
{
    DngDescription description = description_of({ 64, 48 });
    description.shot = full_shot();
    auto tags = by_number(camera_tags(description, {}));
    EXPECT_EQ(std::get<std::string>(tags[270]), "Description");
    EXPECT_EQ(std::get<std::string>(tags[306]), "2024:05:06 07:08:09");
    EXPECT_EQ(std::get<std::string>(tags[315]), "Artist");
    EXPECT_EQ(std::get<std::string>(tags[33432]), "Copyright");
    EXPECT_EQ(std::get<std::vector<std::uint16_t>>(tags[274]).at(0), 6);
}

TEST(DngTags, CropIsTwoPixelsInsideUnlessTinyOrNone)
{
    const auto crop = [](Size size, Crop asked = Crop::border) {
        DngOptions options;
        options.crop = asked;
        auto tags = by_number(mosaic_tags(description_of(size), options));
        const auto& origin = std::get<std::vector<Rational>>(tags[50719]);
        const auto& extent = std::get<std::vector<Rational>>(tags[50720]);
        return std::array<unsigned, 3> { origin.at(0).numerator, extent.at(0).numerator,
                                         extent.at(1).numerator };
    };
    EXPECT_EQ(crop({ 64, 48 }), (std::array<unsigned, 3> { 2, 60, 44 }));
    EXPECT_EQ(crop({ 64, 5 }), (std::array<unsigned, 3> { 0, 64, 5 }));
    EXPECT_EQ(crop({ 64, 48 }, Crop::none), (std::array<unsigned, 3> { 0, 64, 48 }));
}

TEST(DngTags, SixBySixPatterns)
{
    DngDescription description = description_of({ 64, 48 });
    description.cfa = { 6, 6, {} };
    for (std::size_t i = 0; i < 36; ++i)
        description.cfa.colors[i] = std::uint8_t(i % 3);
    description.black_level.assign(36, 512.0);
    auto tags = by_number(mosaic_tags(description, {}));
    EXPECT_EQ(std::get<std::vector<std::uint16_t>>(tags[33421]),
              (std::vector<std::uint16_t> { 6, 6 }));
    EXPECT_EQ(std::get<Bytes>(tags[33422]).size(), 36U);
    EXPECT_EQ(std::get<std::vector<Rational>>(tags[50714]).size(), 36U);
}

TEST(DngTags, FractionsThatDoNotFitAreRefused)
{
    EXPECT_THROW(signed_rational(300.0, 10000000), Error);
    EXPECT_THROW(rational(-0.1, 100), Error);
    EXPECT_THROW(rational(std::nan(""), 100), Error);
    EXPECT_EQ(signed_rational(-0.69415, 10000).numerator, -6942); // half away from zero
}

} // namespace
} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "cg2raw/dng_writer.h"

#include "writer_fixture.h"

#include <tiffio.h>

#include <cstdarg>
#include <functional>

namespace cg2raw {
namespace {

using namespace cg2raw::testing;

class DngWriters : public InFolder {
protected:
    /// The bytes of a file whose rows come @p rows_at_once.
    std::string written(Size size, const DngOptions& options, int rows_at_once,
                        int threads)
    {
        const std::vector<std::uint16_t> dn = mosaic_of(size);
        const Plane<const std::uint16_t> all = plane_of(dn, size);
        DngWriter writer(path(), description_of(size), options,
                         parallel_threads(threads));
        for (int row = 0; row < size.height; row += rows_at_once)
            writer.write_rows({ all.row(row), size.width,
                                std::min(rows_at_once, size.height - row), all.pitch });
        writer.close();
        return bytes_of(path());
    }
};

constexpr Compression kinds[]
    = { Compression::none, Compression::ljpeg, Compression::ljpeg_2d };

TEST_F(DngWriters, SameBytesHoweverRowsArrive)
{
    const Size size { 777, 301 };
    for (const Compression compression : kinds) {
        const DngOptions options { compression };
        const std::string whole = written(size, options, size.height, 1);
        EXPECT_EQ(written(size, options, size.height, 8), whole);
        for (const int rows : { 1, 7, 128, 200 })
            EXPECT_EQ(written(size, options, rows, 2), whole)
                << rows << " rows at once";
    }
}

TEST_F(DngWriters, PixelsOfAWiderImageAreLeftOut)
{
    const Size size { 40, 30 };
    const Size wide { 50, 30 };
    const std::vector<std::uint16_t> dn = mosaic_of(wide);
    std::vector<std::uint16_t> cut;
    for (int row = 0; row < size.height; ++row)
        cut.insert(cut.end(), dn.begin() + row * wide.width,
                   dn.begin() + row * wide.width + size.width);
    for (const Compression compression : kinds) {
        const DngOptions options { compression };
        write_dng(path("a"), plane_of(cut, size), description_of(size), options);
        write_dng(path("b"), { dn.data(), size.width, size.height, wide.width },
                  description_of(size), options);
        EXPECT_EQ(bytes_of(path("a")), bytes_of(path("b")));
    }
}

TEST_F(DngWriters, SizesOfFiles)
{
    const Size size { 640, 480 };
    const std::size_t pixels = 640 * 480;
    EXPECT_LT(written(size, { Compression::none, false }, 480, 1).size(),
              2 * pixels + 2048);
    // Pure noise over the whole range cannot shrink; it grows by its codes only.
    EXPECT_LT(written(size, { Compression::ljpeg, false }, 480, 1).size(),
              2.1 * pixels);
    std::vector<std::uint16_t> smooth;
    for (std::size_t i = 0; i < pixels; ++i)
        smooth.push_back(std::uint16_t(600 + i % 640 + i / 640));
    write_dng(path(), plane_of(smooth, size), description_of(size),
              { Compression::ljpeg, false });
    EXPECT_LT(bytes_of(path()).size(), pixels / 2);
}

TEST_F(DngWriters, NothingAppearsBeforeCloseOrWithoutAllRows)
{
    const Size size { 64, 64 };
    const std::vector<std::uint16_t> dn = mosaic_of(size);
    {
        DngWriter writer(path(), description_of(size), {});
        writer.write_rows({ dn.data(), 64, 40, 64 });
        EXPECT_EQ(message_of([&] { writer.close(); }),
                  path() + ": 40 rows written of 64: write them all before closing");
        EXPECT_FALSE(std::filesystem::exists(path()));
        EXPECT_EQ(message_of([&] {
                      writer.write_rows({ dn.data(), 64, 25, 64 });
                  }),
                  path()
                      + ": rows of 64 pixels, 65 in all, do not fit a 64 x 64 mosaic");
        writer.write_rows({ dn.data(), 64, 24, 64 });
        EXPECT_FALSE(std::filesystem::exists(path()));
        writer.close();
        writer.close();
        EXPECT_EQ(files(), 1);
    }
    EXPECT_EQ(files(), 1);
}

TEST_F(DngWriters, TinyMosaics)
{
    for (const Size size : { Size { 2, 2 }, Size { 3, 5 }, Size { 15, 40 },
                             Size { 17, 3 }, Size { 16, 16 }, Size { 1000, 2 } })
        for (const Compression compression : kinds)
            EXPECT_GT(written(size, { compression }, 1, 1).size(), 500U);
}

struct Wrong {
    const char* name;
    std::function<void(DngDescription&)> spoil;
    const char* message;
};

class WrongDescription : public ::testing::TestWithParam<Wrong> { };

TEST_P(WrongDescription, IsRefusedByFieldValueAndBound)
{
    DngDescription description = description_of({ 64, 48 });
    GetParam().spoil(description);
    EXPECT_EQ(message_of([&] { DngWriter("shot.dng", description, {}); }),
              std::string("shot.dng: ") + GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    Fields, WrongDescription,
    ::testing::Values(
        Wrong { "narrow", [](DngDescription& d) { d.size.width = 1; },
                "width is 1, but must be one repeat of the CFA (2) to 65535 pixels" },
        Wrong {
            "high", [](DngDescription& d) { d.size.height = 65536; },
            "height is 65536, but must be one repeat of the CFA (2) to 65535 pixels" },
        Wrong { "no_blue", [](DngDescription& d) { d.cfa.colors[3] = 1; },
                "cfa is without colour 2, but must be of R, G and B" },
        Wrong { "white", [](DngDescription& d) { d.white_level = 65536; },
                "white_level is 65536, but must be 1 to 65535 DN" },
        Wrong { "blacks", [](DngDescription& d) { d.black_level.pop_back(); },
                "black_level is 3 numbers, but must be one per CFA site" },
        Wrong { "black", [](DngDescription& d) { d.black_level[2] = 16383; },
                "black_level is 16383.000000, but must be at least 0 and below "
                "white_level" },
        Wrong { "matrices", [](DngDescription& d) { d.calibrations.clear(); },
                "calibrations is 0 matrices, but must be one or two" },
        Wrong { "neutral", [](DngDescription& d) { d.as_shot_neutral[0] = 0.0; },
                "as_shot_neutral is 0.000000, but must be 0.001 to 1000, green 1" },
        Wrong { "noise",
                [](DngDescription& d) {
                    d.noise_profile = { { 1e-4, 0.0 } };
                },
                "noise_profile is 1 pairs, but must be none or one per colour" },
        Wrong { "scale",
                [](DngDescription& d) {
                    d.noise_profile.assign(3, { 0.0, 0.0 });
                },
                "noise_profile scale is 0.000000, but must be above 0" },
        Wrong { "date", [](DngDescription& d) { d.shot.date_time_original = "today"; },
                "date_time_original is today, but must be YYYY:MM:DD HH:MM:SS" },
        Wrong { "orientation", [](DngDescription& d) { d.shot.orientation = 9; },
                "orientation is 9, but must be 1 to 8" }),
    [](const auto& info) { return info.param.name; });

TEST_F(DngWriters, RefuseMoreThanFourGigabytesAtOnce)
{
    EXPECT_EQ(
        message_of([&] {
            DngWriter(path(), description_of({ 65535, 65535 }), { Compression::none });
        }),
        path()
            + ": 8589672450 bytes of pixels, but a TIFF file ends at 4 GiB: write a "
              "smaller image, or compress it");
    EXPECT_EQ(files(), 0);
}

int complaints = 0;

void count(const char*, const char*, std::va_list) { ++complaints; }

TEST_F(DngWriters, LeaveTheHostsLibtiffAlone)
{
    const TIFFErrorHandler errors = TIFFSetErrorHandler(count);
    const TIFFErrorHandler warnings = TIFFSetWarningHandler(count);
    ::testing::internal::CaptureStderr();
    written({ 64, 64 }, {}, 64, 1);
    EXPECT_EQ(TIFFSetErrorHandler(errors), &count);
    EXPECT_EQ(TIFFSetWarningHandler(warnings), &count);
    EXPECT_EQ(TIFFSetTagExtender(nullptr), nullptr);
    EXPECT_EQ(complaints, 0);
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(DngOptions, Words)
{
    EXPECT_EQ(compression_from_name("none"), Compression::none);
    EXPECT_EQ(compression_from_name("ljpeg"), Compression::ljpeg);
    EXPECT_EQ(compression_from_name("ljpeg-2d"), Compression::ljpeg_2d);
    EXPECT_EQ(matrices_from_name("exact"), Matrices::exact);
    EXPECT_EQ(tone_curve_from_name("linear"), ToneCurve::linear);
    EXPECT_EQ(message_of([] { compression_from_name("zip"); }),
              "compression is \"zip\", but must be none or ljpeg or "
              "ljpeg-2d");
}

} // namespace
} // namespace cg2raw

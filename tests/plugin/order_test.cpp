// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Pixels may come in any order and shape, from any thread: the bytes are the
/// same; likewise where an effect needs the whole frame.
#include "cg2raw/profile.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imageio.h>

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <thread>

using namespace OIIO;
namespace fs = std::filesystem;

namespace {

constexpr int width = 203, height = 131, tile = 32;

class Order : public testing::Test {
protected:
    fs::path folder
        = fs::temp_directory_path() / ("cg2raw-order-" + std::to_string(getpid()));
    fs::path profiles = folder.string() + "-profiles";
    std::string sensor = "samsung-s20fe";
    std::vector<float> pixels = std::vector<float>(3 * width * height);

    void SetUp() override
    {
        fs::create_directories(folder);
        fs::create_directories(profiles);
        for (std::size_t i = 0; i < pixels.size(); ++i)
            pixels[i] = float(i * 2654435761u % 10007u) / 9000.0f;
    }
    void TearDown() override
    {
        fs::remove_all(folder);
        fs::remove_all(profiles);
    }

    /// Makes the sensor one whose effects need the whole frame.
    void take_blurred_sensor()
    {
        cg2raw::SensorProfile profile = cg2raw::load_profile(sensor);
        profile.effects = {
            { "blur", { { "red_scale", 1.0 }, { "blue_scale", 1.0 } }, {} },
            { "veiling_glare", { { "uniform", 0.05 }, { "wide", 0.05 } }, {} },
            { "noise_reduction", { { "blend", 0.3 }, { "diagonal", 0.1 } }, {} },
        };
        for (int ring = 1; ring <= 10; ++ring)
            profile.effects[0].parameters["ring_" + std::to_string(ring)] = 0.02;
        sensor = (profiles / "blurred.json").string();
        std::ofstream(sensor) << cg2raw::to_json(profile);
    }

    ImageSpec spec(const char* compression) const
    {
        ImageSpec result(width, height, 3, TypeDesc::FLOAT);
        result.attribute("dng:sensor", sensor);
        result.attribute("dng:illuminant", "A");
        result.attribute("dng:iso", 800);
        result.attribute("dng:seed", 11);
        result.attribute("dng:compression", compression);
        return result;
    }

    std::unique_ptr<ImageOutput> opened(const std::string& name, const ImageSpec& spec)
    {
        auto output = ImageOutput::create(name);
        EXPECT_TRUE(output) << geterror();
        EXPECT_TRUE(output->open((folder / name).string(), spec)) << output->geterror();
        return output;
    }

    std::string bytes(const std::string& name) const
    {
        std::ifstream file(folder / name, std::ios::binary);
        return { std::istreambuf_iterator<char>(file), {} };
    }

    /// Without a number, which would be that of another frame.
    static std::string name_of(int i) { return std::string(1, char('p' + i)) + ".dng"; }

    const float* row(int y) const { return pixels.data() + 3 * width * y; }

    void write_in_order(const std::string& name, const ImageSpec& spec)
    {
        auto output = opened(name, spec);
        EXPECT_TRUE(output->write_image(TypeDesc::FLOAT, pixels.data()))
            << output->geterror();
        EXPECT_TRUE(output->close()) << output->geterror();
    }
};

struct Way {
    const char* compression;
    bool needs_whole_frame;
};

class OrderOf : public Order, public testing::WithParamInterface<Way> {
protected:
    void SetUp() override
    {
        Order::SetUp();
        if (GetParam().needs_whole_frame)
            take_blurred_sensor();
    }
    ImageSpec asked() const { return spec(GetParam().compression); }
};

TEST_P(OrderOf, RowsMayComeBackwards)
{
    write_in_order("a.dng", asked());
    auto output = opened("b.dng", asked());
    for (int y = height - 1; y >= 0; --y)
        EXPECT_TRUE(output->write_scanline(y, 0, TypeDesc::FLOAT, row(y)));
    EXPECT_TRUE(output->close()) << output->geterror();
    EXPECT_EQ(bytes("a.dng"), bytes("b.dng"));
    EXPECT_GT(bytes("a.dng").size(), 1000u);
}

TEST_P(OrderOf, TilesMayComeInAnyOrder)
{
    write_in_order("a.dng", asked());
    ImageSpec tiled = asked();
    tiled.tile_width = tiled.tile_height = tile;
    auto output = opened("b.dng", tiled);
    std::vector<int> order((width + tile - 1) / tile * ((height + tile - 1) / tile));
    std::iota(order.begin(), order.end(), 0);
    std::reverse(order.begin(), order.end() - 3);
    for (int index : order) {
        const int x = index % ((width + tile - 1) / tile) * tile;
        const int y = index / ((width + tile - 1) / tile) * tile;
        std::vector<float> block(3 * tile * tile, 0.0f);
        for (int dy = 0; dy < std::min(tile, height - y); ++dy)
            std::copy_n(row(y + dy) + 3 * x, 3 * std::min(tile, width - x),
                        block.begin() + 3 * tile * dy);
        EXPECT_TRUE(output->write_tile(x, y, 0, TypeDesc::FLOAT, block.data()));
    }
    EXPECT_TRUE(output->close()) << output->geterror();
    EXPECT_EQ(bytes("a.dng"), bytes("b.dng"));
}

TEST_P(OrderOf, SeveralThreadsWriteSeveralFiles)
{
    write_in_order("a.dng", asked());
    std::vector<std::thread> threads;
    for (int i = 0; i < 6; ++i)
        threads.emplace_back([&, i] { write_in_order(name_of(i), asked()); });
    for (std::thread& thread : threads)
        thread.join();
    for (int i = 0; i < 6; ++i)
        EXPECT_EQ(bytes("a.dng"), bytes(name_of(i)));
}

TEST_P(OrderOf, MissingRowsLeaveNoFile)
{
    auto output = opened("a.dng", asked());
    EXPECT_TRUE(output->write_scanline(0, 0, TypeDesc::FLOAT, row(0)));
    EXPECT_TRUE(output->write_scanline(5, 0, TypeDesc::FLOAT, row(5)));
    EXPECT_FALSE(output->close());
    EXPECT_NE(output->geterror().find("row 1"), std::string::npos);
    EXPECT_TRUE(fs::is_empty(folder));
}

TEST_P(OrderOf, AnOutputThatIsDroppedLeavesNoFile)
{
    opened("a.dng", asked())->write_scanline(0, 0, TypeDesc::FLOAT, row(0));
    EXPECT_TRUE(fs::is_empty(folder));
}

TEST_P(OrderOf, RowsTwiceAreAnError)
{
    auto output = opened("a.dng", asked());
    EXPECT_TRUE(output->write_scanline(0, 0, TypeDesc::FLOAT, row(0)));
    EXPECT_FALSE(output->write_scanline(0, 0, TypeDesc::FLOAT, row(0)));
    EXPECT_TRUE(fs::is_empty(folder));
}

TEST_P(OrderOf, AFailureInOneThreadEndsTheOthers)
{
    for (int round = 0; round < 40; ++round) {
        auto output = opened("a.dng", asked());
        std::atomic<int> said { 0 }; // OpenImageIO keeps errors by thread
        std::vector<std::thread> threads;
        for (int i = 0; i < 4; ++i)
            threads.emplace_back([&] {
                if (!output->write_scanline(0, 0, TypeDesc::FLOAT, row(0)))
                    said += output->geterror().find("was written") != std::string::npos;
            });
        for (std::thread& thread : threads)
            thread.join();
        EXPECT_TRUE(output->close()); // the failure was reported when it happened
        EXPECT_EQ(said, 1);
        EXPECT_TRUE(fs::is_empty(folder));
    }
}

INSTANTIATE_TEST_SUITE_P(Ways, OrderOf,
                         testing::Values(Way { "none", false }, Way { "ljpeg", false },
                                         Way { "none", true }, Way { "ljpeg", true }));

TEST_F(Order, TheWholeFrameMakesADifference)
{
    write_in_order("a.dng", spec("none"));
    take_blurred_sensor();
    write_in_order("b.dng", spec("none"));
    // Behind the header come the pixels; what the file says of its effects is last.
    const auto samples = [&](const char* name) {
        return bytes(name).substr(8, sizeof(std::uint16_t) * pixels.size() / 3);
    };
    EXPECT_NE(samples("a.dng"), samples("b.dng"));
}

TEST_F(Order, ImageBufWrites)
{
    write_in_order("a.dng", spec("none"));
    ImageBuf image(spec("none"), pixels.data());
    EXPECT_TRUE(image.write((folder / "b.dng").string())) << image.geterror();
    EXPECT_EQ(bytes("a.dng"), bytes("b.dng"));
}

TEST_F(Order, OneOutputWritesFileAfterFile)
{
    write_in_order("a.dng", spec("none"));
    auto output = ImageOutput::create("b.dng");
    for (const char* name : { "b.dng", "c.dng" }) {
        ASSERT_TRUE(output->open((folder / name).string(), spec("none")));
        EXPECT_TRUE(output->write_image(TypeDesc::FLOAT, pixels.data()));
        EXPECT_TRUE(output->close());
        EXPECT_EQ(bytes("a.dng"), bytes(name));
    }
}

} // namespace

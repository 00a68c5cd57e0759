// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Ways to read that a command line does not have: from memory, from several
/// threads, rows in any order, one object for several files.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>

using namespace OIIO;
namespace fs = std::filesystem;

namespace {

constexpr int width = 203, height = 131;

class Reading : public testing::Test {
protected:
    fs::path folder
        = fs::temp_directory_path() / ("cg2raw-reading-" + std::to_string(getpid()));
    std::string path = (folder / "shot.dng").string();

    void SetUp() override
    {
        fs::create_directories(folder);
        ImageSpec spec(width, height, 3, TypeDesc::FLOAT);
        spec.attribute("dng:sensor", "samsung-s20fe");
        spec.attribute("dng:illuminant", "A");
        spec.attribute("dng:iso", 800);
        std::vector<float> pixels(std::size_t(3) * width * height);
        for (std::size_t i = 0; i < pixels.size(); ++i)
            pixels[i] = float(i * 2654435761u % 10007u) / 12000.0f;
        auto output = ImageOutput::create(path);
        ASSERT_TRUE(output && output->open(path, spec)
                    && output->write_image(TypeDesc::FLOAT, pixels.data())
                    && output->close());
    }
    void TearDown() override { fs::remove_all(folder); }

    static std::unique_ptr<ImageInput> reader() { return ImageInput::create("cg2raw"); }

    template <class Value>
    static std::vector<Value> all(ImageInput& input, TypeDesc type)
    {
        const ImageSpec spec = input.spec();
        std::vector<Value> pixels(
            std::size_t(spec.width * spec.height * spec.nchannels));
        EXPECT_TRUE(input.read_image(0, 0, 0, spec.nchannels, type, pixels.data()))
            << input.geterror();
        return pixels;
    }

    std::vector<std::uint16_t> words()
    {
        const auto input = reader();
        ImageSpec spec;
        EXPECT_TRUE(input->open(path, spec)) << input->geterror();
        return all<std::uint16_t>(*input, TypeDesc::UINT16);
    }
};

TEST_F(Reading, FromMemoryIsTheSame)
{
    std::ifstream file(path, std::ios::binary);
    std::string bytes { std::istreambuf_iterator<char>(file), {} };
    Filesystem::IOMemReader memory(bytes.data(), bytes.size());
    const auto input = reader();
    ASSERT_TRUE(input->supports("ioproxy") && input->set_ioproxy(&memory));
    ImageSpec spec;
    ASSERT_TRUE(input->open("in memory.dng", spec)) << input->geterror();
    EXPECT_EQ(all<std::uint16_t>(*input, TypeDesc::UINT16), words());
}

TEST_F(Reading, RowsBackwardsAreTheSame)
{
    for (const int developed : { 0, 1 }) {
        ImageSpec hints, spec;
        hints.attribute("dng:developed", developed);
        const auto input = reader();
        ASSERT_TRUE(input->open(path, spec, hints)) << input->geterror();
        const auto whole = all<float>(*input, TypeDesc::FLOAT);
        const std::size_t row = std::size_t(width * spec.nchannels);
        std::vector<float> pixels(row);
        for (int y = height - 1; y >= 0; --y) {
            ASSERT_TRUE(input->read_scanline(y, 0, TypeDesc::FLOAT, pixels.data()));
            EXPECT_TRUE(std::equal(pixels.begin(), pixels.end(),
                                   whole.begin() + std::ptrdiff_t(row) * y))
                << y;
        }
    }
}

TEST_F(Reading, SeveralThreadsShareOneFile)
{
    const auto expected = words();
    const auto input = reader();
    ImageSpec spec;
    ASSERT_TRUE(input->open(path, spec)) << input->geterror();
    std::atomic<int> wrong { 0 };
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i)
        threads.emplace_back([&, i] {
            std::vector<std::uint16_t> row(width);
            for (int y = i; y < height; y += 3) {
                const bool read = input->read_scanlines(0, 0, y, y + 1, 0, 0, 1,
                                                        TypeDesc::UINT16, row.data());
                wrong += !read
                    || !std::equal(row.begin(), row.end(),
                                   expected.begin() + std::ptrdiff_t(width) * y);
            }
        });
    for (std::thread& thread : threads)
        thread.join();
    EXPECT_EQ(wrong, 0);
}

TEST_F(Reading, OneObjectReadsOneFileAfterAnother)
{
    const auto input = reader();
    ImageSpec hints, spec;
    hints.attribute("dng:developed", 1);
    ASSERT_TRUE(input->open(path, spec, hints));
    EXPECT_EQ(spec.nchannels, 3);
    EXPECT_FALSE(input->open((folder / "none.dng").string(), spec));
    EXPECT_NE(input->geterror(), "");
    ASSERT_TRUE(input->open(path, spec)) << input->geterror();
    EXPECT_EQ(spec.nchannels, 1);
    EXPECT_EQ(all<std::uint16_t>(*input, TypeDesc::UINT16), words());
    EXPECT_TRUE(input->close());
    std::vector<std::uint16_t> row(width);
    EXPECT_FALSE(input->read_scanline(0, 0, TypeDesc::UINT16, row.data()));
}

TEST_F(Reading, KnowsItsFiles)
{
    std::ofstream(folder / "text.dng") << "II*";
    const auto input = reader();
    EXPECT_TRUE(input->valid_file(path));
    EXPECT_FALSE(input->valid_file((folder / "text.dng").string()));
    EXPECT_FALSE(input->valid_file((folder / "none.dng").string()));
    ImageSpec spec;
    ASSERT_TRUE(input->open(path, spec));
    EXPECT_FALSE(input->seek_subimage(1, 0));
    EXPECT_TRUE(input->seek_subimage(0, 0));
}

} // namespace

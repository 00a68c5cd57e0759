// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The corpus, and with it all that fuzzing ever found, without libFuzzer.
#include "counted_memory.h"
#include "targets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <new>
#include <sstream>

namespace cg2raw::test {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> corpus(const std::string& folder)
{
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(fs::path("tests/fuzz") / folder))
        files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

std::string bytes_of(const fs::path& path)
{
    std::ostringstream bytes;
    bytes << std::ifstream(path, std::ios::binary).rdbuf();
    return bytes.str();
}

struct Target {
    const char* folder;
    bool (*own)(std::string_view);
    bool (*other)(std::string_view);
};

class Corpus : public testing::TestWithParam<Target> { };

TEST_P(Corpus, BringsAboutNoFinding)
{
    const auto files = corpus(GetParam().folder);
    std::size_t accepted = 0;
    for (const fs::path& file : files) {
        const std::string bytes = bytes_of(file);
        EXPECT_NO_THROW(accepted += GetParam().own(bytes) ? 1 : 0) << file;
        EXPECT_NO_THROW(EXPECT_FALSE(GetParam().other(bytes))) << file;
    }
    // A corpus that the reader refuses at the door would show nothing.
    EXPECT_GE(files.size(), 24U);
    EXPECT_GE(accepted, 12U);
    EXPECT_LT(accepted, files.size());
}

TEST_P(Corpus, IsSmall)
{
    std::size_t all = 0;
    for (const fs::path& file : corpus(GetParam().folder)) {
        EXPECT_LT(fs::file_size(file), 4096U) << file;
        all += fs::file_size(file);
    }
    EXPECT_LT(all, 75U << 10);
}

std::vector<Target> targets()
{
    return {
        { "dng", fuzz_dng_reader, fuzz_profile },
        { "illuminant", fuzz_illuminant, fuzz_profile },
        { "jpeg", fuzz_jpeg, fuzz_profile },
        { "mosaic", fuzz_mosaic, fuzz_profile },
#ifdef CG2RAW_FUZZ_PLUGIN
        { "plugin", fuzz_plugin, fuzz_profile },
#endif
        { "profile", fuzz_profile, fuzz_dng_reader },
        { "spectra", fuzz_spectra, fuzz_profile },
    };
}

INSTANTIATE_TEST_SUITE_P(Fuzz, Corpus, testing::ValuesIn(targets()),
                         [](const auto& test) {
                             return std::string(test.param.folder);
                         });

TEST(Targets, SeeMemoryBeyondTheBound)
{
    constexpr MemoryBound bound { 1000, 2 };
    const auto take = [&](std::size_t size) {
        const auto use_memory = [=] {
            const std::vector<char> taken(size, '\0');
            // Seen, or a compiler may leave the memory out.
            const volatile char* const seen = taken.data();
            static_cast<void>(*seen);
        };
        return bounded(use_memory, 100, bound, "a file");
    };
    EXPECT_TRUE(take(1100));
    EXPECT_THROW(take(1300), Finding);
}

TEST(Targets, SeeAnErrorThatDoesNotNameTheFile)
{
    const auto fail = [](const char* message) {
        return bounded([=] { throw Error(message); }, 0, { 4096, 0 }, "a file");
    };
    EXPECT_FALSE(fail("a file: is damaged"));
    EXPECT_THROW(fail("is damaged"), Finding);
}

TEST(Targets, SeeWhatIsNoMessage)
{
    EXPECT_NO_THROW(check_message("a file: is damaged"));
    for (const std::string& text :
         { std::string(), std::string("a file: is\ndamaged"), std::string(2001, 'a') })
        EXPECT_THROW(check_message(text), Finding);
}

TEST(Targets, SeeAProfileThatDoesNotReadBack)
{
    SensorProfile profile
        = parse_profile(bytes_of("tests/fuzz/profile/one_matrix"), "one_matrix");
    EXPECT_NO_THROW(use(profile));
    profile.bits = 99;
    EXPECT_THROW(use(profile), Finding);
}

TEST(MemoryMeter, CountsWhatIsHeldAtOnce)
{
    const MemoryMeter meter;
    for (int i = 0; i < 3; ++i)
        ::operator delete(::operator new(5000));
    EXPECT_GE(meter.most(), 5000U);
    EXPECT_LT(meter.most(), 6000U);
    EXPECT_EQ(meter.largest(), 5000U);
    ::operator delete(::operator new(9000, std::nothrow));
    EXPECT_GE(meter.most(), 9000U);
}

} // namespace
} // namespace cg2raw::test

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What the writer's tests share: a legal description, a mosaic, a folder.
#pragma once

#include "cg2raw/dng_writer.h"

#include "platform/paths.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <string>

namespace cg2raw::testing {

/// All that a DNG needs of a sensor that never was; 14 bits.
inline DngDescription description_of(Size size)
{
    DngDescription description {};
    description.size = size;
    description.cfa = cfa_from_name("rggb");
    description.black_level = { 512, 512, 512, 512 };
    description.white_level = 16383;
    description.calibrations = {
        { 21, { { 0.7, -0.2, -0.1, -0.5, 1.3, 0.2, -0.1, 0.2, 0.6 } }, std::nullopt }
    };
    description.as_shot_neutral = { 0.5, 1.0, 0.7 };
    description.make = "Maker";
    description.model = "Model";
    description.unique_camera_model = "Maker Model";
    description.srgb_from_balanced = { { 1, 0, 0, 0, 1, 0, 0, 0, 1 } };
    return description;
}

/// Values all over the range, the same everywhere.
inline std::vector<std::uint16_t> mosaic_of(Size size, int white_level = 16383)
{
    std::vector<std::uint16_t> dn(std::size_t(size.width) * std::size_t(size.height));
    std::uint32_t state = 1;
    for (std::uint16_t& value : dn) {
        state = state * 1664525U + 1013904223U; // Numerical Recipes' generator
        value = std::uint16_t((state >> 8) % unsigned(white_level + 1));
    }
    return dn;
}

inline Plane<const std::uint16_t> plane_of(const std::vector<std::uint16_t>& dn,
                                           Size size)
{
    return { dn.data(), size.width, size.height, size.width };
}

inline std::string bytes_of(const std::filesystem::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return { std::istreambuf_iterator<char>(file), {} };
}

/// A folder of its own for each test; it goes with the test.
class InFolder : public ::testing::Test {
protected:
    InFolder()
    {
        const auto parent = std::filesystem::temp_directory_path();
        std::random_device random;
        do
            folder = parent / ("cg2raw-" + std::to_string(random()));
        while (!std::filesystem::create_directory(folder));
    }
    ~InFolder() override { std::filesystem::remove_all(folder); }

    std::string path(const std::string& name = "shot.dng") const
    {
        return utf8_of(folder / name);
    }
    int files() const
    {
        return int(std::distance(std::filesystem::directory_iterator(folder), {}));
    }

    std::filesystem::path folder;
};

/// What an action that fails says.
inline std::string message_of(const std::function<void()>& action)
{
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

} // namespace cg2raw::testing

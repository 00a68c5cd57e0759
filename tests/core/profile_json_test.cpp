// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file to_json() of what only a program can put together: Python and files cannot.
#include "cg2raw/profile.h"

#include <gtest/gtest.h>

namespace cg2raw {
namespace {

SensorProfile legal()
{
    SensorProfile profile {};
    profile.id = "test-sensor";
    profile.make = profile.model = profile.unique_camera_model = "Test";
    profile.cfa = cfa_from_name("rggb");
    profile.width = profile.height = 64;
    profile.bits = 14;
    profile.black_level = { 512, 512, 512, 512 };
    profile.white_level = 16383;
    profile.calibrations
        = { { 21, { { 0.7, -0.1, -0.1, -0.4, 1.3, 0.2, -0.1, 0.2, 0.6 } }, {} } };
    return profile;
}

std::string error_of(const SensorProfile& profile)
{
    try {
        to_json(profile);
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

TEST(ToJson, OfALegalProfileReadsBack)
{
    const std::string json = to_json(legal());
    EXPECT_EQ(to_json(parse_profile(json, "test.json")), json);
}

TEST(ToJson, RefusesTextThatIsNoUtf8)
{
    SensorProfile profile = legal();
    profile.sources = { { "noise", "caf\xE9" } };
    EXPECT_EQ(
        error_of(profile).rfind("sensor test-sensor cannot be written as JSON", 0), 0U)
        << error_of(profile);
}

TEST(ToJson, RefusesEvidenceThatIsNoObject)
{
    for (const char* evidence : { "{\"evidence\": ", "[1]", "7" }) {
        SensorProfile profile = legal();
        profile.effects = { { "row_noise", {}, evidence } };
        EXPECT_NE(error_of(profile).find("evidence the text of an object"),
                  std::string::npos)
            << evidence;
    }
}

} // namespace
} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The tree holds what nlohmann's holds, and writes it the same.
#include "profile_json_tree.h"

#include "cg2raw/types.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace cg2raw {
namespace {

constexpr const char* texts[] = {
    "null",
    "[]",
    "{}",
    "[[], {}, [1, [2, {\"a\": []}]], null, true, false]",
    "[0, -1, 18446744073709551615, -9223372036854775808, 1.0, 0.1, 1e300, 5e-324]",
    "{\"b\": 1, \"a\": {\"z\": \"x\", \"y\": [\"\\u00e9\", \"\\\"\\\\\\n\\u0001\"]}}",
    "\"caf\\u00e9 \\ud83d\\ude00\"",
};

TEST(JsonTree, IsWrittenAsByNlohmann)
{
    for (const char* text : texts) {
        const auto other = nlohmann::ordered_json::parse(text);
        const JsonTree tree = JsonTree::parse(text);
        EXPECT_EQ(tree.dump(), other.dump(2));
        EXPECT_EQ(tree.dump(true), other.dump());
        EXPECT_EQ(tree.shown(), other.dump(-1, ' ', true));
        EXPECT_EQ(JsonTree::parse(tree.dump()).dump(), tree.dump());
    }
}

TEST(JsonTree, SaysWhatIsNoJson)
{
    for (const char* text : { "", "{", "[1,]", "nul", "\"\x80\"", "1 2" })
        EXPECT_THROW(JsonTree::parse(text), Error) << text;
    EXPECT_THROW(JsonTree("caf\xE9").dump(), Error);
    EXPECT_EQ(JsonTree("caf\xE9").shown(), "\"caf\\ufffd\"");
}

TEST(JsonTree, MembersKeepTheirPlace)
{
    JsonTree tree = JsonTree::object().with("b", 1).with("a", "x");
    tree.set("b", 2.5);
    tree.set("c", std::vector<std::array<double, 2>> { { 1, 2 } });
    tree.update(JsonTree::object().with("a", true).with("d", JsonTree()));
    EXPECT_EQ(tree.dump(true), "{\"b\":2.5,\"a\":true,\"c\":[[1.0,2.0]],\"d\":null}");
    EXPECT_EQ(tree.find("b")->number(), 2.5);
    EXPECT_EQ(tree.find("e"), nullptr);
}

TEST(JsonTree, AnotherKindIsAnError)
{
    const JsonTree tree = JsonTree::parse("[7, \"x\"]");
    EXPECT_EQ(tree.items()[0].number(), 7.0);
    EXPECT_EQ(tree.items()[1].text(), "x");
    EXPECT_THROW(tree.members(), Error);
    EXPECT_THROW(tree.items()[0].text(), Error);
    EXPECT_THROW(tree.items()[1].number(), Error);
    EXPECT_THROW(JsonTree::object().update(tree), Error);
}

} // namespace
} // namespace cg2raw

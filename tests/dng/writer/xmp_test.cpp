// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The XMP packet: always there, well-formed whatever the texts are, bounded.
#include "writer/tags.h"

#include "writer_fixture.h"

namespace cg2raw {
namespace {

using namespace cg2raw::testing;

/// The packet of a description with this illuminant.
std::string packet_of(const std::string& illuminant)
{
    DngDescription description = description_of({ 64, 48 });
    description.origin.illuminant = illuminant;
    return xmp_packet(description);
}

bool has(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

TEST(Xmp, SaysComputerGeneratedOfAnyDescription)
{
    const std::string packet = xmp_packet(description_of({ 64, 48 }));
    EXPECT_TRUE(
        has(packet,
            "<Iptc4xmpExt:DigitalSourceType>http://cv.iptc.org/newscodes/"
            "digitalsourcetype/digitalCreation</Iptc4xmpExt:DigitalSourceType>"));
    EXPECT_TRUE(has(packet, "<xmp:CreatorTool>cg2raw "));
    EXPECT_TRUE(has(packet, "<cg2raw:Neutral>0.5 1 0.7</cg2raw:Neutral>"));
    for (const char* unknown : { "Sensor", "Illuminant", "ColorTemperature", "ISO",
                                 "Convention", "DigitalGain", "Seed", "Effects" })
        EXPECT_FALSE(has(packet, std::string("cg2raw:") + unknown)) << unknown;
}

TEST(Xmp, EscapesMarkup)
{
    const std::string packet = packet_of("lamp:a<b>&\"c'");
    EXPECT_TRUE(has(packet, ">lamp:a&lt;b&gt;&amp;\"c'</cg2raw:Illuminant>"));
}

TEST(Xmp, HoldsNoCharacterThatXmlForbids)
{
    EXPECT_TRUE(has(packet_of("a\x01"
                              "b\x1F"
                              "c"),
                    ">a b c<"));
    EXPECT_TRUE(has(packet_of("a\xEF\xBF\xBE\xEF\xBF\xBF"
                              "b"),
                    ">a??b<"));
    EXPECT_TRUE(has(packet_of("a\xFF"
                              "b"),
                    ">a?b<"));
}

TEST(Xmp, CutsLongTextsBetweenCharacters)
{
    const auto text = [](std::size_t count) {
        std::string umlauts;
        for (std::size_t i = 0; i < count; ++i)
            umlauts += "\xC3\xBC";
        return umlauts;
    };
    EXPECT_TRUE(has(packet_of(text(128)), ">" + text(128) + "<"));
    EXPECT_TRUE(has(packet_of("a" + text(500)), ">a" + text(127) + "<"));
}

TEST(Xmp, OfNumbersIsExact)
{
    DngDescription description = description_of({ 64, 48 });
    description.origin.seed = 18446744073709551615U;
    description.origin.iso = 1600.7;
    description.origin.temperature = 2855.5;
    const std::string packet = xmp_packet(description);
    EXPECT_TRUE(has(packet, ">18446744073709551615</cg2raw:Seed>"));
    EXPECT_TRUE(has(packet, ">1600.7</cg2raw:ISO>"));
    EXPECT_TRUE(has(packet, ">2856</cg2raw:ColorTemperature>"));
}

TEST(Xmp, OfAMonochromeSensorHasNoNeutral)
{
    DngDescription description = description_of({ 64, 48 });
    description.cfa = mono_cfa();
    EXPECT_FALSE(has(xmp_packet(description), "cg2raw:Neutral"));
}

} // namespace
} // namespace cg2raw

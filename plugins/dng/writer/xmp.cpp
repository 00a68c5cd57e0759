// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What a file says of itself in XMP, whose serialisation ISO 16684-1 defines.
#include "writer/tags.h"

#include "tiff/text.h"

#include <charconv>
#include <cmath>

namespace cg2raw {

namespace {

/// "Media created by a human using non-generative tools": the term that took the place
/// of softwareImage and digitalArt. A render is no algorithmicMedia, an image "created
/// purely by an algorithm", as its scene is somebody's work. Source: IPTC NewsCodes,
/// Digital Source Type, release of 23 October 2024.
constexpr const char* source_type
    = "http://cv.iptc.org/newscodes/digitalsourcetype/digitalCreation";
constexpr const char* xmp_namespace = "http://ns.adobe.com/xap/1.0/";
/// Source: IPTC Photo Metadata Standard 2023.2.
constexpr const char* iptc_namespace = "http://iptc.org/std/Iptc4xmpExt/2008-02-29/";
/// A name, not an address.
constexpr const char* own_namespace = "urn:cg2raw:simulation:1.0/";
constexpr std::size_t longest_text = 256;

/// @p text with at most longest_text bytes, cut off between characters of its UTF-8.
std::string bounded(std::string text)
{
    if (text.size() <= longest_text)
        return text;
    std::size_t end = longest_text;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80)
        --end;
    return text.substr(0, end);
}

/// @p text as XML may hold it: markup escaped, without U+FFFE and U+FFFF, which XML 1.0
/// has no place for.
std::string escaped(const std::string& text)
{
    std::string result;
    const std::string legal = bounded(printable_text(text));
    for (std::size_t i = 0; i < legal.size(); ++i) {
        const std::string_view three = std::string_view(legal).substr(i, 3);
        if (three == "\xEF\xBF\xBE" || three == "\xEF\xBF\xBF") {
            result += '?';
            i += 2;
        } else if (legal[i] == '&') {
            result += "&amp;";
        } else if (legal[i] == '<') {
            result += "&lt;";
        } else if (legal[i] == '>') {
            result += "&gt;";
        } else {
            result += legal[i];
        }
    }
    return result;
}

/// The shortest text that reads back as @p value; none of nothing.
template <class Number> std::string text_of(const std::optional<Number>& value)
{
    char buffer[40];
    if (!value)
        return {};
    const auto result = std::to_chars(buffer, buffer + sizeof buffer, *value);
    return { buffer, result.ptr };
}

/// Properties, one a line.
class Properties {
public:
    void add(const std::string& name, const std::string& text)
    {
        if (!text.empty())
            m_xml += "   <" + name + ">" + escaped(text) + "</" + name + ">\n";
    }
    /// An ordered list.
    void add(const std::string& name, const std::vector<std::string>& texts)
    {
        m_xml += "   <" + name + ">\n    <rdf:Seq>\n";
        for (const std::string& text : texts)
            m_xml += "     <rdf:li>" + escaped(text) + "</rdf:li>\n";
        m_xml += "    </rdf:Seq>\n   </" + name + ">\n";
    }

    const std::string& xml() const { return m_xml; }

private:
    std::string m_xml;
};

/// Camera RGB of a neutral patch, as AsShotNeutral has it.
std::string neutral_text(const DngDescription& description)
{
    if (description.cfa.is_mono())
        return {};
    std::string text;
    for (const double channel : description.as_shot_neutral)
        text += (text.empty() ? "" : " ") + text_of(std::optional(channel));
    return text;
}

void add_origin(Properties& properties, const DngDescription& description)
{
    const Origin& origin = description.origin;
    properties.add("cg2raw:Version", CG2RAW_VERSION);
    properties.add("cg2raw:Sensor", origin.sensor);
    properties.add("cg2raw:Illuminant", origin.illuminant);
    properties.add("cg2raw:Neutral", neutral_text(description));
    if (origin.temperature)
        properties.add("cg2raw:ColorTemperature",
                       text_of(std::optional(std::round(*origin.temperature))));
    properties.add("cg2raw:ISO", text_of(origin.iso));
    properties.add("cg2raw:Convention", origin.convention);
    properties.add("cg2raw:Exposure", text_of(origin.exposure));
    properties.add("cg2raw:ExposureRule", origin.exposure_rule);
    properties.add("cg2raw:DigitalGain", text_of(origin.digital_gain));
    properties.add("cg2raw:Seed", text_of(origin.seed));
    properties.add("cg2raw:Frame", text_of(origin.frame));
    if (!origin.effects.empty())
        properties.add("cg2raw:Effects", origin.effects);
}

} // namespace

std::string xmp_packet(const DngDescription& description)
{
    Properties properties;
    properties.add("xmp:CreatorTool", "cg2raw " CG2RAW_VERSION);
    properties.add("Iptc4xmpExt:DigitalSourceType", source_type);
    add_origin(properties, description);
    const auto space = [](const char* prefix, const char* name) {
        return std::string("\n    xmlns:") + prefix + "=\"" + name + "\"";
    };
    return "<?xpacket begin=\"\xEF\xBB\xBF\" id=\"W5M0MpCehiHzreSzNTczkc9d\"?>\n"
           "<x:xmpmeta xmlns:x=\"adobe:ns:meta/\">\n"
           " <rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">\n"
           "  <rdf:Description rdf:about=\"\""
        + space("xmp", xmp_namespace) + space("Iptc4xmpExt", iptc_namespace)
        + space("cg2raw", own_namespace) + ">\n" + properties.xml()
        + "  </rdf:Description>\n </rdf:RDF>\n</x:xmpmeta>\n<?xpacket end=\"w\"?>";
}

} // namespace cg2raw

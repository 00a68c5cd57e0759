// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "attributes.h"

#include "platform/numbers.h"

#include <OpenImageIO/strutil.h>

#include <charconv>

namespace cg2raw {
namespace {

/// The shortest text that reads back as @p value: what was typed, up to six digits.
/// oiiotool turns 0.7 into a float; as a double that would be another number than 0.7
/// in Python.
std::string shortest(float value)
{
    char buffer[40];
    const auto result = std::to_chars(buffer, buffer + sizeof buffer, value);
    return { buffer, result.ptr };
}

/// The number that all of @p text is, in the C locale; NaN if it is none.
double number_from(std::string_view text)
{
    if (!text.empty() && text.front() == '+')
        text.remove_prefix(1);
    return number_in(text);
}

/// An attribute's name and value, whatever its type.
struct Given {
    std::string name;
    OIIO::ParamValue value;

    std::string text() const
    {
        const bool is_float = value.type() == OIIO::TypeDesc::FLOAT;
        return is_float ? shortest(value.get_float())
                        : std::string(OIIO::Strutil::strip(value.get_string()));
    }

    [[noreturn]] void fail(const std::string& allowed) const
    {
        throw Error(name + " \"" + text() + "\" must be " + allowed);
    }

    double real(double low, double high, const std::string& allowed) const
    {
        const double number = number_from(text());
        if (!(number >= low && number <= high))
            fail(allowed);
        return number;
    }

    /// A whole number from 0; 64 bits when it is given as text.
    std::uint64_t whole() const
    {
        return std::stoull(whole_text(false, "0 to 999999999999999999"));
    }

    /// The number of a frame, which may be below 0.
    std::int64_t frame() const
    {
        return std::stoll(
            whole_text(true, "-999999999999999999 to 999999999999999999"));
    }

    std::string whole_text(bool may_be_negative, const std::string& range) const
    {
        if (value.type() == OIIO::TypeDesc::INT && value.get_int() == 2147483647)
            fail("below 2147483647, where oiiotool's integers end; larger ones as "
                 "--attrib:type=string");
        const std::string number = text();
        const auto digits = std::string_view(number).substr(
            may_be_negative && !number.empty() && number[0] == '-');
        if (digits.empty() || digits.size() > 18
            || digits.find_first_not_of("0123456789") != digits.npos)
            fail("a whole number from " + range);
        return number;
    }

    bool flag() const
    {
        const std::string word = OIIO::Strutil::lower(text());
        if (word == "1" || word == "true" || word == "on" || word == "yes")
            return true;
        if (word == "0" || word == "false" || word == "off" || word == "no")
            return false;
        fail("0 or 1");
    }

    /// The result of @p parse, whose error gets this attribute's name.
    template <class Parse> auto named(const Parse& parse) const
    {
        try {
            return parse(OIIO::Strutil::lower(text()));
        } catch (const Error& error) {
            throw Error(name + ": " + error.what());
        }
    }
};

bool effects_from(const Given& given)
{
    const std::string word = OIIO::Strutil::lower(given.text());
    if (word != "profile" && word != "none")
        given.fail("profile or none");
    return word == "profile";
}

void set_gain(Attributes& a, const Given& given)
{
    a.sample_gain = OIIO::Strutil::iequals(given.text(), "sample");
    if (!a.sample_gain)
        a.gain = given.real(0.001, 1000.0, "0.001 to 1000, or sample");
}

struct Known {
    const char* name;
    void (*set)(Attributes&, const Given&);
};

constexpr Known known[] = {
    { "dng:sensor", [](Attributes& a, const Given& g) { a.sensor = g.text(); } },
    { "dng:reference", [](Attributes& a, const Given& g) { a.reference = g.text(); } },
    { "dng:illuminant",
      [](Attributes& a, const Given& g) { a.illuminant = g.text(); } },
    { "dng:layer", [](Attributes& a, const Given& g) { a.layer = g.text(); } },
    { "dng:linearize",
      [](Attributes& a, const Given& g) {
          if (!OIIO::Strutil::iequals(g.text(), "srgb"))
              g.fail("srgb");
          a.linearize = true;
      } },
    { "dng:iso",
      [](Attributes& a, const Given& g) {
          a.iso = g.real(1.0, 1e7, "an ISO from 1 to 10000000");
      } },
    { "dng:exposure",
      [](Attributes& a, const Given& g) {
          a.exposure = g.real(1e-6, 1e12, "the luminance of white in cd/m2, above 0");
      } },
    { "dng:noise",
      [](Attributes& a, const Given& g) { a.noise = g.named(noise_model_from_name); } },
    { "dng:seed", [](Attributes& a, const Given& g) { a.seed = g.whole(); } },
    { "dng:frame", [](Attributes& a, const Given& g) { a.frame = g.frame(); } },
    { "dng:framerate",
      [](Attributes& a, const Given& g) {
          a.frame_rate = g.named(frame_rate_from_text);
      } },
    { "dng:timecode",
      [](Attributes& a, const Given& g) {
          a.time_code = g.named(time_code_from_text);
      } },
    { "dng:first_frame",
      [](Attributes& a, const Given& g) { a.first_frame = g.frame(); } },
    { "dng:reel", [](Attributes& a, const Given& g) { a.reel = g.text(); } },
    { "dng:camera_label",
      [](Attributes& a, const Given& g) { a.camera_label = g.text(); } },
    { "dng:gain", set_gain },
    { "dng:convention",
      [](Attributes& a, const Given& g) {
          a.convention = g.named(convention_from_name);
      } },
    { "dng:matrices",
      [](Attributes& a, const Given& g) {
          a.options.matrices = g.named(matrices_from_name);
      } },
    { "dng:highlights",
      [](Attributes& a, const Given& g) { a.highlights = g.flag(); } },
    { "dng:effects",
      [](Attributes& a, const Given& g) { a.effects = effects_from(g); } },
    { "dng:compression",
      [](Attributes& a, const Given& g) {
          a.compression = g.named(compression_from_name);
      } },
    { "dng:preview",
      [](Attributes& a, const Given& g) { a.options.preview = g.flag(); } },
    { "dng:shading",
      [](Attributes& a, const Given& g) {
          a.options.shading = g.named(shading_from_name);
      } },
    { "dng:crop",
      [](Attributes& a, const Given& g) { a.options.crop = g.named(crop_from_name); } },
    { "dng:tone_curve",
      [](Attributes& a, const Given& g) {
          a.options.tone_curve = g.named(tone_curve_from_name);
      } },
};

[[noreturn]] void fail_unknown(const std::string& name)
{
    std::string names;
    for (const Known& attribute : known)
        names += std::string(names.empty() ? "" : ", ") + attribute.name;
    throw Error("attribute " + name + " is unknown; known: " + names);
}

/// dng:compression, else what the host says as it does for all formats: "none" of
/// oiiotool's --compression, or of an input that was not compressed, and "ljpeg-2d".
/// Other words name codecs of other formats, as a rule the input's; the mosaic is
/// compressed then.
Compression compression_of(const OIIO::ImageSpec& spec, const Attributes& attributes)
{
    if (attributes.compression)
        return *attributes.compression;
    const std::string host(spec.get_string_attribute("compression"));
    if (OIIO::Strutil::iequals(host, "none"))
        return Compression::none;
    return OIIO::Strutil::iequals(host, "ljpeg-2d") ? Compression::ljpeg_2d
                                                    : Compression::ljpeg;
}

} // namespace

Attributes attributes_of(const OIIO::ImageSpec& spec)
{
    Attributes attributes;
    for (const OIIO::ParamValue& param : spec.extra_attribs) {
        const std::string name(param.name().string());
        if (!OIIO::Strutil::istarts_with(name, "dng:"))
            continue;
        const Known* found = nullptr;
        for (const Known& candidate : known)
            if (OIIO::Strutil::iequals(name, candidate.name))
                found = &candidate;
        if (!found)
            fail_unknown(name);
        found->set(attributes, { name, param });
    }
    attributes.options.compression = compression_of(spec, attributes);
    return attributes;
}

} // namespace cg2raw

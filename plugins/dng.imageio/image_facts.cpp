// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "image_facts.h"

#include "color_config.h"

#include <OpenImageIO/strutil.h>

#include <algorithm>
#include <charconv>
#include <utility>
#include <vector>

namespace cg2raw {
namespace {

using OIIO::ImageSpec;
using OIIO::ParamValue;
using OIIO::TypeDesc;

/// Numbers beyond these are no metadata of ours: profiles and pictures.
constexpr std::size_t most_numbers = 16;

/// The shortest text that reads back as @p value: what was typed, up to six digits.
/// oiiotool turns 0.7 into a float; as a double that would be another number than 0.7
/// in Python.
std::string shortest(float value)
{
    char buffer[40];
    const auto result = std::to_chars(buffer, buffer + sizeof buffer, value);
    return { buffer, result.ptr };
}

/// What an attribute states, if it is a text or a few numbers.
std::optional<Metadata::Value> stated(const ParamValue& attribute)
{
    const TypeDesc type = attribute.type();
    if (type.basetype == TypeDesc::STRING || type == OIIO::TypeRational)
        return attribute.get_string();
    if (type == OIIO::TypeTimeCode) {
        const auto* const packed = static_cast<const std::uint32_t*>(attribute.data());
        return Metadata::Numbers { { double(packed[0]), double(packed[1]) } };
    }
    const std::size_t count = type.basevalues() * std::size_t(attribute.nvalues());
    if (count == 0 || count > most_numbers || type.basetype == TypeDesc::PTR)
        return std::nullopt;
    Metadata::Numbers numbers;
    for (int i = 0; i < int(count); ++i) // OpenImageIO 2.4 makes no float of an int
        numbers.values.push_back(type.is_floating_point()
                                     ? double(attribute.get_float_indexed(i))
                                     : double(attribute.get_int_indexed(i)));
    return numbers;
}

Metadata stated_metadata(const ImageSpec& spec)
{
    Metadata metadata;
    for (const ParamValue& attribute : spec.extra_attribs)
        if (auto value = stated(attribute))
            metadata.add(attribute.name().string(), *std::move(value));
    return metadata;
}

/// The name that a file will have: oiiotool writes <stem>.<8 hex digits>.temp.<ending>
/// and renames that.
std::string final_name(const std::string& file)
{
    constexpr std::size_t digits = 8;
    const auto temp = file.rfind(".temp.");
    if (temp == file.npos || temp <= digits || file[temp - digits - 1] != '.'
        || file.substr(temp - digits, digits).find_first_not_of("0123456789abcdef")
            != file.npos)
        return file;
    return file.substr(0, temp - digits - 1) + file.substr(temp + 5);
}

/// The type of the samples in the file that was read, as far as a host says it: what it
/// states is the type to write. OpenEXR, whose every file has a screenWindowWidth, has
/// floats.
std::string samples(const ImageSpec& spec)
{
    const bool is_exr = spec.find_attribute("screenWindowWidth") != nullptr;
    return is_exr ? "float" : std::string(spec.format.c_str());
}

/// Names of the channels that the host's pixels have.
ScenePart names(const ImageSpec& spec)
{
    const auto count = std::size_t(std::max(spec.nchannels, 0));
    if (spec.channelnames.size() > count)
        throw Error("its pixels have " + std::to_string(spec.nchannels)
                    + " channels, and it names "
                    + std::to_string(spec.channelnames.size())
                    + ": give a name to each");
    ScenePart part { std::string(spec.get_string_attribute("oiio:subimagename")),
                     spec.channelnames };
    part.channels.resize(count);
    return part;
}

/// The text of an attribute's value, whatever its type.
std::string text(const ParamValue& attribute, const Dialect& dialect,
                 const std::string& name)
{
    const TypeDesc type = attribute.type();
    if (type == TypeDesc::FLOAT)
        return shortest(attribute.get_float());
    if (type == TypeDesc::INT && attribute.get_int() == 2147483647)
        throw Error(
            dialect.option(name, "")
            + " \"2147483647\" must be below 2147483647, "
              "where oiiotool's integers end; larger ones as --attrib:type=string");
    return attribute.get_string();
}

constexpr std::string_view prefix = "dng:";

std::string as_attribute(std::string_view name, std::string_view value)
{
    const std::string attribute = std::string(prefix).append(name);
    return value.empty() ? attribute
                         : "--attrib " + attribute + " " + std::string(value);
}

} // namespace

ImageFacts image_facts(const ImageSpec& spec, const std::string& name)
{
    ImagePart part { names(spec), samples(spec), !spec.deep && spec.depth <= 1,
                     stated_metadata(spec) };
    // Floats have as many bits as "-d" asks for; whole numbers those of their file, of
    // which a DPX has 10 or 12.
    const bool is_wish = levels_of(part.samples) == 0;
    const int bits = is_wish ? spec.get_int_attribute("oiio:BitsPerSample", 0) : 0;
    return { { std::move(part) }, "", final_name(name), std::nullopt, bits,
             OIIO_VERSION,        {} };
}

ExportOptions attribute_options(const ImageSpec& spec)
{
    ExportOptions options;
    const Dialect& dialect = attribute_dialect();
    for (const ParamValue& attribute : spec.extra_attribs) {
        const std::string name(attribute.name().string());
        if (!OIIO::Strutil::istarts_with(name, std::string(prefix)))
            continue;
        const std::string option = name.substr(prefix.size());
        options.set(option, text(attribute, dialect, option), dialect);
    }
    return options;
}

const Dialect& attribute_dialect()
{
    static const Dialect dialect { as_attribute, is_rec709_word, rec709_space,
                                   "--iscolorspace lin_rec709", true };
    return dialect;
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What a host may ask of the plugin, a line each. Of the image that it will
/// open:
///
///     size WIDTH HEIGHT CHANNELS FORMAT    data X Y    full X Y WIDTH HEIGHT
///     tile WIDTH HEIGHT    depth N    deep N    channels NAME ...    pad BYTES
///     attribute TYPE NAME VALUE ...
///
/// and of the file:
///
///     open [NAME]    append [NAME]    close    drop    image FORMAT
///     rows FIRST END FORMAT    pixels X Y FORMAT (a tile's)
///
/// Other lines say nothing. Files are called a.dng unless they have a NAME.
#include "host_file.h"
#include "scratch_folder.h"
#include "targets.h"

#include <OpenImageIO/imageio.h>

#include <cstring>
#include <sstream>

using namespace OIIO;

namespace cg2raw::test {
namespace {

/// Numbers of an attribute as bytes of its type, zeros behind the last.
std::vector<char> bytes_of(std::istringstream& words, TypeDesc type)
{
    std::vector<char> bytes(type.size(), 0);
    const std::size_t step = type.basesize();
    std::size_t at = 0;
    for (double number; at < bytes.size() && words >> number; at += step) {
        // Beyond an integer's range the cast would be our own fault.
        const bool fits = number > -9e18 && number < 9e18;
        const auto whole = static_cast<long long>(fits ? number : 0.0);
        const auto real = static_cast<float>(fits ? number : 9e18);
        if (type.basetype == TypeDesc::FLOAT)
            std::memcpy(&bytes[at], &real, sizeof real);
        else if (type.basetype == TypeDesc::DOUBLE)
            std::memcpy(&bytes[at], &number, sizeof number);
        else
            std::memcpy(&bytes[at], &whole, std::min(step, sizeof whole));
    }
    return bytes;
}

void add_attribute(std::istringstream& words, ImageSpec& spec)
{
    constexpr std::size_t largest = 4096;
    std::string type_name, name, text;
    words >> type_name >> name;
    const TypeDesc type(type_name.c_str());
    if (type.basetype == TypeDesc::UNKNOWN || type.basetype == TypeDesc::PTR
        || type.arraylen < 0 || type.size() > largest)
        return;
    if (type.basetype != TypeDesc::STRING) {
        spec.attribute(name, type, bytes_of(words, type).data());
        return;
    }
    std::getline(words >> std::ws, text);
    for (std::size_t at = 0; (at = text.find("\\n", at)) != text.npos;)
        text.replace(at, 2, "\n");
    const std::vector<const char*> all(type.numelements() * type.aggregate,
                                       text.c_str());
    spec.attribute(name, type, all.data());
}

void set_size(std::istringstream& words, ImageSpec& spec)
{
    constexpr int most_names = 64;
    int width = 0, height = 0, channels = 0;
    std::string format;
    words >> width >> height >> channels >> format;
    ImageSpec sized(width, height, std::clamp(channels, 0, most_names),
                    TypeDesc(format.c_str()));
    sized.nchannels = channels;
    sized.extra_attribs = spec.extra_attribs;
    spec = sized;
}

/// Whether a line is about the image: then it is done.
bool describe(const std::string& verb, std::istringstream& words, ImageSpec& spec)
{
    if (verb == "size")
        set_size(words, spec);
    else if (verb == "data")
        words >> spec.x >> spec.y;
    else if (verb == "full")
        words >> spec.full_x >> spec.full_y >> spec.full_width >> spec.full_height;
    else if (verb == "tile")
        words >> spec.tile_width >> spec.tile_height;
    else if (verb == "depth")
        words >> spec.depth;
    else if (verb == "deep")
        spec.deep = true;
    else if (verb == "attribute")
        add_attribute(words, spec);
    else if (verb == "channels") {
        spec.channelnames.clear();
        for (std::string name; words >> name;)
            spec.channelnames.push_back(name);
    } else
        return false;
    return true;
}

/// A name in the scratch folder.
std::string name_in(std::istringstream& words)
{
    std::string name;
    std::getline(words >> std::ws, name);
    std::replace(name.begin(), name.end(), '/', '_');
    return name.empty() || name == "." || name == ".." ? "a.dng" : name;
}

void call(const std::string& verb, std::istringstream& words, const ImageSpec& spec,
          HostFile& file)
{
    int a = 0, b = 0;
    std::string format;
    if (verb == "open" || verb == "append")
        file.open(name_in(words), spec,
                  verb == "open" ? ImageOutput::Create : ImageOutput::AppendSubimage);
    else if (verb == "close")
        file.close();
    else if (verb == "drop")
        file.drop();
    else if (verb == "pad" && words >> a)
        file.pad(a);
    else if (verb == "image" && words >> format)
        file.write_image(TypeDesc(format.c_str()));
    else if (verb == "rows" && words >> a >> b >> format)
        file.write_rows(a, b, TypeDesc(format.c_str()));
    else if (verb == "pixels" && words >> a >> b >> format)
        file.write_tile(a, b, TypeDesc(format.c_str()));
}

bool run(std::string_view bytes, const ScratchFolder& folder)
{
    ImageSpec spec(8, 8, 3, TypeDesc::FLOAT);
    HostFile file(folder);
    std::istringstream lines { std::string(bytes) };
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string verb;
        words >> verb;
        if (!describe(verb, words, spec))
            call(verb, words, spec, file);
    }
    file.drop();
    return file.published();
}

} // namespace

bool fuzz_plugin(std::string_view bytes)
{
    static const ScratchFolder folder;
    static const bool is_single = attribute("threads", 1);
    static bool is_warm = false; // the first input opens what stays open
    const std::size_t before = open_descriptors();
    folder.clear();
    const bool published = run(bytes, folder);
    if (is_single && is_warm && open_descriptors() != before)
        throw Finding("a file stays open");
    is_warm = true;
    return published;
}

} // namespace cg2raw::test

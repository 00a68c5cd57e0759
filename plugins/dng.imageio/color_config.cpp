// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "color_config.h"

#include "cg2raw/color.h"

#include <OpenImageIO/color.h>
#include <OpenImageIO/strutil.h>

#include <cstdlib>
#include <fstream>

namespace cg2raw {
namespace {

namespace Strutil = OIIO::Strutil;

/// The config that the host has loaded, or a new one.
decltype(auto) current_config()
{
#if OIIO_VERSION >= 30000
    return OIIO::ColorConfig::default_colorconfig();
#else
    return OIIO::ColorConfig();
#endif
}

/// What the file of a config says of the role scene_linear, without the rest of it:
/// "scene_linear: NAME" in the block "roles:", as OpenColorIO writes it. Empty if that
/// is not found.
std::string stated_scene_linear(const char* path)
{
    std::ifstream file(path);
    bool in_roles = false;
    for (std::string line; std::getline(file, line);) {
        if (!in_roles) {
            in_roles = Strutil::strip(line) == "roles:" && line[0] == 'r';
            continue;
        }
        if (line.empty() || line[0] != ' ')
            break;
        const auto colon = line.find(':');
        if (colon == line.npos
            || Strutil::strip(line.substr(0, colon)) != "scene_linear")
            continue;
        return std::string(Strutil::strip(line.substr(colon + 1), " \t\r\"'"));
    }
    return "";
}

} // namespace

bool is_rec709_word([[maybe_unused]] const std::string& word)
{
    const char* const path = std::getenv("OCIO");
#if OIIO_VERSION >= 30000
    if (Strutil::iequals(word, "linear")) // a name of a space, not the role
        return is_rec709_name(std::string(current_config().resolve(word)));
#else
    if (!path)
        return true;
#endif
    if (path && is_rec709_name(stated_scene_linear(path)))
        return true;
    const auto& config = current_config();
    const char* const role = config.getColorSpaceNameByRole("scene_linear");
    return !role || is_rec709_name(role);
}

std::string rec709_space()
{
    const auto& config = current_config();
    for (int i = 0; i < config.getNumColorSpaces(); ++i)
        if (is_rec709_name(config.getColorSpaceNameByIndex(i)))
            return config.getColorSpaceNameByIndex(i);
    return std::getenv("OCIO") ? "<the config's linear Rec.709 space>" : "linear";
}

} // namespace cg2raw

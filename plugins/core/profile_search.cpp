// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Where profiles lie.
#include "cg2raw/profile.h"

#include "platform/paths.h"
#include "profile_syntax.h"
#include "text.h"
#include "text_file.h"

#include <algorithm>
#include <filesystem>

namespace cg2raw {
namespace {

namespace fs = std::filesystem;

std::string in_quotes(std::string_view text) { return '"' + quotable(text) + '"'; }

/// Whether a path leads to a file: what is there may be a pipe, or a link to nothing.
bool has_file(const fs::path& path)
{
    std::error_code ignored;
    return fs::is_regular_file(path, ignored);
}

std::string read_profile(const fs::path& path)
{
    std::error_code ignored;
    const std::string remedy = fs::is_directory(path, ignored)
        ? "give the path of a profile (.json) in it"
        : "give the path of a profile (.json), or the id of an installed sensor";
    return read_text_file(path, remedy, [&](std::uintmax_t size) {
        check_profile_size(size, utf8_of(path));
    });
}

bool is_path(const std::string& id_or_path)
{
    const std::string ending = ".json";
    return has_folder(id_or_path)
        || (id_or_path.size() > ending.size()
            && id_or_path.compare(id_or_path.size() - ending.size(), ending.size(),
                                  ending)
                == 0);
}

/// Throws Error for a word that no file can be named by, before a file is sought.
void check_word(const std::string& word)
{
    const bool has_control = std::any_of(
        word.begin(), word.end(), [](unsigned char c) { return c < ' ' || c == 0x7f; });
    const bool is_dots
        = !word.empty() && word.find_first_not_of('.') == std::string::npos;
    if (is_path(word) ? word.find('\0') == std::string::npos
                      : !has_control && !is_dots && word.size() <= longest_sensor_id)
        return;
    throw Error("sensor "
                + (is_path(word) ? "path " + in_quotes(word) + " has a null byte"
                                 : sensor_id_fault(word))
                + "; or give the path of a profile (.json)");
}

} // namespace

std::string sensor_id_fault(std::string_view id)
{
    constexpr std::string_view legal = "abcdefghijklmnopqrstuvwxyz0123456789-.";
    const bool is_legal = id.find_first_not_of(legal) == std::string_view::npos
        && id.find_first_of("-.") != 0 && !id.empty();
    if (is_legal && id.size() <= longest_sensor_id)
        return "";
    return in_quotes(id) + " must be of lower-case letters, digits, '-' and '.', begin "
        + "with a letter or digit, and have up to " + std::to_string(longest_sensor_id)
        + " characters" + (is_legal ? ", not " + std::to_string(id.size()) : "");
}

std::vector<std::string> profile_folders()
{
    std::vector<std::string> folders;
    for (const std::string& folder :
         split(environment("CG2RAW_PROFILE_PATH"), path_list_separator))
        if (!folder.empty())
            folders.push_back(folder);
    const fs::path own = own_folder();
    for (const char* relative :
         { "share/cg2raw/profiles", "../../../share/cg2raw/profiles" }) {
        std::error_code ignored;
        const fs::path folder = fs::weakly_canonical(own / relative, ignored);
        if (fs::is_directory(folder, ignored))
            folders.push_back(utf8_of(folder));
    }
    return folders;
}

std::vector<std::string> installed_profiles()
{
    std::vector<std::string> ids;
    for (const std::string& folder : profile_folders())
        for (const std::string& name : names_in(path_of(folder)))
            if (const fs::path path = path_of(name);
                path.extension() == ".json" && has_file(path_of(folder) / path))
                ids.push_back(utf8_of(path.stem()));
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    return ids;
}

SensorProfile load_profile(const std::string& id_or_path)
{
    check_word(id_or_path);
    if (is_path(id_or_path))
        return parse_profile(read_profile(path_of(id_or_path)), id_or_path);
    for (const std::string& folder : profile_folders()) {
        const fs::path path = path_of(folder) / path_of(id_or_path + ".json");
        if (!id_or_path.empty() && has_file(path))
            return parse_profile(read_profile(path), utf8_of(path));
    }
    const auto installed = installed_profiles();
    throw Error("unknown sensor \"" + id_or_path + "\"; installed: "
                + (installed.empty()
                       ? "none (CG2RAW_PROFILE_PATH names folders of profiles)"
                       : joined(installed))
                + "; or give the path of a profile (.json)");
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Which frame of a shot a file is.
#include "cg2raw/scene_file.h"

#include "text.h"

#include <string>

namespace cg2raw {
namespace {

constexpr std::string_view digits = "0123456789";
/// More are no frame number, and would not fit in 64 bits.
constexpr std::size_t most_digits = 18;

std::optional<std::uint64_t> number_of(std::string_view text)
{
    if (text.empty() || text.size() > most_digits
        || text.find_first_not_of(digits) != text.npos)
        return std::nullopt;
    return std::stoull(std::string(text));
}

/// The digits that @p name ends with, unless a lone "v" stands before them.
std::optional<std::uint64_t> number_at_end(std::string_view name)
{
    const auto last = name.find_last_not_of(digits);
    const std::size_t first = last == name.npos ? 0 : last + 1;
    const bool is_version = first > 0
        && (name[first - 1] == 'v' || name[first - 1] == 'V')
        && (first == 1 || std::string_view("._- ").find(name[first - 2]) != name.npos);
    return is_version ? std::nullopt : number_of(name.substr(first));
}

} // namespace

std::optional<std::uint64_t> frame_from_name(std::string_view path)
{
    std::string_view name = path.substr(path.find_last_of("/\\") + 1);
    if (const auto dot = name.rfind('.'); dot != name.npos && dot > 0)
        name = name.substr(0, dot);
    for (std::size_t end = name.size(); end > 0;) {
        const auto separator = name.find_last_of("._- ", end - 1);
        const std::size_t begin = separator == name.npos ? 0 : separator + 1;
        if (const auto number = number_of(name.substr(begin, end - begin)))
            return number;
        end = begin == 0 ? 0 : begin - 1;
    }
    return number_at_end(name);
}

std::optional<std::uint64_t> frame_from_time_code(std::string_view text)
{
    std::string number;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool is_separator = i % 3 == 2 && (text[i] == ':' || text[i] == ';');
        if (!is_separator)
            number += text[i];
    }
    constexpr std::size_t length = std::string_view("hh:mm:ss:ff").size();
    if (text.size() != length || number.size() != 8)
        return std::nullopt;
    return number_of(number);
}

} // namespace cg2raw

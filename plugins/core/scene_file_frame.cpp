// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Which frame of a shot a file is.
#include "cg2raw/scene_file.h"

#include "text.h"

#include <string>

namespace cg2raw {
namespace {

constexpr std::string_view digits = "0123456789", separators = "._- ";
/// More are no frame number, and would not fit in 64 bits.
constexpr std::size_t most_digits = 18;

bool is_number(std::string_view text)
{
    return !text.empty() && text.size() <= most_digits
        && text.find_first_not_of(digits) == text.npos;
}

bool is_separator(char letter) { return separators.find(letter) != separators.npos; }

/// Where a frame number stands in a name, with its sign.
struct Place {
    std::size_t first, end;
};

/// The last part of @p name between separators that is all digits.
std::optional<Place> part_in(std::string_view name)
{
    for (std::size_t end = name.size(); end > 0;) {
        const auto separator = name.find_last_of(separators, end - 1);
        const std::size_t first = separator == name.npos ? 0 : separator + 1;
        if (is_number(name.substr(first, end - first))) {
            const bool has_sign = first > 0 && name[first - 1] == '-'
                && (first == 1 || is_separator(name[first - 2]));
            return Place { has_sign ? first - 1 : first, end };
        }
        end = first == 0 ? 0 : first - 1;
    }
    return std::nullopt;
}

/// The digits that @p name ends with, unless a lone "v" stands before them.
std::optional<Place> end_of(std::string_view name)
{
    const auto last = name.find_last_not_of(digits);
    const std::size_t first = last == name.npos ? 0 : last + 1;
    const bool is_version = first > 0
        && (name[first - 1] == 'v' || name[first - 1] == 'V')
        && (first == 1 || is_separator(name[first - 2]));
    if (is_version || !is_number(name.substr(first)))
        return std::nullopt;
    return Place { first, name.size() };
}

} // namespace

std::optional<FrameName> frame_name(std::string_view path)
{
    const std::size_t start = path.find_last_of("/\\") + 1;
    std::string_view name = path.substr(start);
    if (const auto dot = name.rfind('.'); dot != name.npos && dot > 0)
        name = name.substr(0, dot);
    const auto part = part_in(name), place = part ? part : end_of(name);
    if (!place)
        return std::nullopt;
    const auto [first, end] = *place;
    return FrameName { std::string(path.substr(0, start + first)),
                       std::stoll(std::string(name.substr(first, end - first))),
                       std::string(path.substr(start + end)) };
}

std::optional<std::int64_t> frame_from_time_code(std::string_view text)
{
    std::string number;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool is_colon = i % 3 == 2 && (text[i] == ':' || text[i] == ';');
        if (!is_colon)
            number += text[i];
    }
    constexpr std::size_t length = std::string_view("hh:mm:ss:ff").size();
    if (text.size() != length || number.size() != 8 || !is_number(number))
        return std::nullopt;
    return std::stoll(number);
}

} // namespace cg2raw

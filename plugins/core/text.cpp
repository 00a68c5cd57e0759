// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "text.h"

#include "platform/numbers.h"

#include <algorithm>
#include <cctype>
#include <charconv>

namespace cg2raw {
namespace {

/// A character of UTF-8 and its bytes.
struct Character {
    char32_t code;
    std::size_t size;
};

bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; }

/// The character that @p text, which is not empty, begins with; of size 0 if it begins
/// with none. Source: RFC 3629, 4.
Character first_character(std::string_view text)
{
    const auto lead = static_cast<unsigned char>(text[0]);
    if (lead < 0x80)
        return { lead, 1 };
    const std::size_t size = lead < 0xc2 ? 0
        : lead < 0xe0                    ? 2
        : lead < 0xf0                    ? 3
        : lead < 0xf5                    ? 4
                                         : 0;
    if (size == 0 || text.size() < size)
        return { 0, 0 };
    char32_t code = lead & (0x7f >> size);
    for (std::size_t i = 1; i < size; ++i) {
        if (!is_continuation(text[i]))
            return { 0, 0 };
        code = code << 6 | (static_cast<unsigned char>(text[i]) & 0x3f);
    }
    constexpr char32_t least[] = { 0, 0, 0x80, 0x800, 0x10000 };
    const bool is_surrogate = code >= 0xd800 && code <= 0xdfff;
    return { code, code < least[size] || code > 0x10ffff || is_surrogate ? 0 : size };
}

bool is_printable(char32_t code)
{
    const bool is_control = code < 0x20 || (code >= 0x7f && code <= 0x9f);
    return !is_control && code != 0x2028 && code != 0x2029;
}

/// The start and the end of @p text, whole characters, @p most bytes in all.
std::string without_middle(const std::string& text, std::size_t most)
{
    constexpr std::string_view gap = " ... ";
    std::size_t start = (most - gap.size()) / 2, end = text.size() - start;
    while (start > 0 && is_continuation(text[start]))
        --start;
    while (end < text.size() && is_continuation(text[end]))
        ++end;
    return text.substr(0, start).append(gap).append(text, end);
}

} // namespace

std::string lower_case(std::string_view text)
{
    std::string result(text);
    std::transform(result.begin(), result.end(), result.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    return result;
}

std::string joined(const std::vector<std::string>& words)
{
    std::string text;
    for (const std::string& word : words)
        text += (text.empty() ? "" : ", ") + word;
    return text;
}

std::vector<std::string> split(std::string_view text, char separator)
{
    std::vector<std::string> parts;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(separator, begin), text.size());
        parts.emplace_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return parts;
}

std::string number(double value)
{
    char buffer[40];
    const auto result = std::to_chars(buffer, buffer + sizeof buffer, value);
    return { buffer, result.ptr };
}

double signed_number(std::string_view text)
{
    if (!text.empty() && text.front() == '+')
        text.remove_prefix(1);
    return number_in(text);
}

double number_or_fraction(std::string_view text)
{
    const auto slash = text.find('/');
    return slash == text.npos
        ? number_in(text)
        : number_in(text.substr(0, slash)) / number_in(text.substr(slash + 1));
}

std::string quotable(std::string_view text)
{
    constexpr std::size_t most = 160;
    std::string result(text.substr(0, most));
    for (char& c : result)
        if (c < ' ' || c > '~')
            c = '?';
    return text.size() > most ? result + "..." : result;
}

std::string one_line(std::string_view text, std::size_t most)
{
    std::string line;
    line.reserve(text.size());
    while (!text.empty()) {
        const Character first = first_character(text);
        const std::size_t size = std::max<std::size_t>(first.size, 1);
        if (first.size > 0 && is_printable(first.code))
            line.append(text.substr(0, size));
        else
            line += '?';
        text.remove_prefix(size);
    }
    return line.size() > most ? without_middle(line, most) : line;
}

} // namespace cg2raw

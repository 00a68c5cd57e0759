// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "tiff/text.h"

namespace cg2raw {
namespace {

unsigned char byte_at(std::string_view text, std::size_t i)
{
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0;
}

/// Bytes that the lead byte of a UTF-8 character announces; 0 if it is no lead byte.
std::size_t announced_length(unsigned char lead)
{
    if (lead < 0x80)
        return 1;
    if (lead >= 0xC2 && lead < 0xE0)
        return 2;
    if (lead >= 0xE0 && lead < 0xF0)
        return 3;
    return lead >= 0xF0 && lead < 0xF5 ? 4 : 0;
}

/// Bytes of the UTF-8 character that @p text starts with; 0 if it starts with none.
/// Overlong forms, surrogates and numbers above 10FFFF are none. Source: RFC 3629.
std::size_t utf8_length(std::string_view text)
{
    const unsigned char lead = byte_at(text, 0), second = byte_at(text, 1);
    const std::size_t length = announced_length(lead);
    for (std::size_t i = 1; i < length; ++i)
        if ((byte_at(text, i) & 0xC0) != 0x80)
            return 0;
    if ((lead == 0xE0 && second < 0xA0) || (lead == 0xF0 && second < 0x90)
        || (lead == 0xED && second >= 0xA0) || (lead == 0xF4 && second >= 0x90))
        return 0;
    return length;
}

} // namespace

std::string printable_text(std::string_view text)
{
    text = text.substr(0, text.find('\0'));
    std::string result;
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t length = utf8_length(text.substr(i));
        if (length == 0)
            result += '?';
        else if (byte_at(text, i) < 0x20 || byte_at(text, i) == 0x7F)
            result += ' ';
        else
            result += text.substr(i, length);
        i += length == 0 ? 1 : length;
    }
    const std::size_t begin = result.find_first_not_of(' ');
    if (begin == std::string::npos)
        return {};
    return result.substr(begin, result.find_last_not_of(' ') - begin + 1);
}

} // namespace cg2raw

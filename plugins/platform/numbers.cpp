// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "platform/numbers.h"

#include <charconv>
#include <limits>

#ifndef __cpp_lib_to_chars // libc++ reads integers only; its systems have strtod_l()
#include <clocale>
#include <cstdlib>
#include <string>
#ifdef __APPLE__
#include <xlocale.h>
#endif
#endif

namespace cg2raw {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

} // namespace

#ifdef __cpp_lib_to_chars
double number_in(std::string_view text)
{
    double value = 0.0;
    const char* const end = text.data() + text.size();
    const auto result = std::from_chars(text.data(), end, value);
    const bool whole = result.ec == std::errc() && result.ptr == end && !text.empty();
    return whole ? value : none;
}
#else
double number_in(std::string_view text)
{
    // strtod() takes more: spaces, a plus, hexadecimal digits.
    const bool is_decimal
        = text.find_first_not_of("+-.0123456789eE") == std::string_view::npos;
    if (text.empty() || !is_decimal || text.front() == '+')
        return none;
    static const locale_t c_locale = ::newlocale(LC_ALL_MASK, "C", nullptr);
    const std::string copy(text);
    char* end = nullptr;
    const double value = ::strtod_l(copy.c_str(), &end, c_locale);
    const bool finite = value - value == 0.0; // else beyond float64
    return finite && end == copy.c_str() + copy.size() ? value : none;
}
#endif

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Small words for messages and names; private to the core.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cg2raw {

std::string lower_case(std::string_view text);
/// "a, b, c"
std::string joined(const std::vector<std::string>& words);
std::vector<std::string> split(std::string_view text, char separator);
/// A number as people write it: shortest form that reads back the same.
std::string number(double value);
/// The number that all of @p text is, perhaps after a plus; NaN if it is none.
double signed_number(std::string_view text);
/// Of "0.5" or "1/48"; NaN of other texts.
double number_or_fraction(std::string_view text);
/// As much of a stranger's text as a message holds, of printable ASCII alone.
std::string quotable(std::string_view text);
/// @p text as one line of UTF-8: '?' for what is none, for control characters and for
/// separators of lines. Above @p most bytes (8 or more) it is cut to its start and its
/// end, with " ... " between.
std::string one_line(std::string_view text, std::size_t most);

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/export.h"

#include "core/text.h"
#include "platform/numbers.h"

#include <cmath>

namespace cg2raw {
namespace {

/// Of "0.5" or "1/48"; 0 of other texts.
double number_of_text(std::string_view text)
{
    const auto slash = text.find('/');
    const double value = slash == text.npos
        ? number_in(text)
        : number_in(text.substr(0, slash)) / number_in(text.substr(slash + 1));
    return std::isfinite(value) ? value : 0.0;
}

} // namespace

void Metadata::add(std::string_view name, Value value)
{
    m_values.emplace(lower_case(name), std::move(value));
}

const Metadata::Value* Metadata::find(std::string_view name) const
{
    const auto found = m_values.find(lower_case(name));
    return found == m_values.end() ? nullptr : &found->second;
}

std::string Metadata::text(std::string_view name) const
{
    const Value* const value = find(name);
    if (!value)
        return "";
    if (const auto* text = std::get_if<std::string>(value))
        return *text;
    std::vector<std::string> numbers;
    for (const double one : std::get<std::vector<double>>(*value))
        numbers.push_back(cg2raw::number(one));
    return joined(numbers);
}

std::string Metadata::text(std::initializer_list<const char*> names) const
{
    for (const char* name : names)
        if (const std::string found = text(name); !found.empty())
            return found;
    return "";
}

double Metadata::number(std::string_view name) const
{
    const Value* const value = find(name);
    if (!value)
        return 0.0;
    if (const auto* text = std::get_if<std::string>(value))
        return number_of_text(*text);
    const auto& numbers = std::get<std::vector<double>>(*value);
    return numbers.size() == 1 ? numbers[0] : 0.0;
}

} // namespace cg2raw

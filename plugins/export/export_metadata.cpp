// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/export.h"

#include "core/text.h"

#include <cmath>

namespace cg2raw {

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
    for (const double one : std::get<Numbers>(*value).values)
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
    if (const auto* text = std::get_if<std::string>(value)) {
        const double number = number_or_fraction(*text);
        return std::isfinite(number) ? number : 0.0;
    }
    const auto& numbers = std::get<Numbers>(*value).values;
    return numbers.size() == 1 ? numbers[0] : 0.0;
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "profile_json_fields.h"

#include "cfa.h"
#include "text.h"

#include <cmath>

namespace cg2raw {
namespace {

std::string shown(const Fields::Json& value)
{
    const std::string text
        = value.dump(-1, ' ', true, Fields::Json::error_handler_t::replace);
    return text.size() > 40 ? text.substr(0, 40) + "..." : text;
}

} // namespace

Fields::Fields(const Json& json, std::string file, std::string path)
    : m_json(json)
    , m_file(std::move(file))
    , m_path(std::move(path))
{
    if (!json.is_object())
        fail("", "must be an object");
}

void Fields::fail(const std::string& field, const std::string& what) const
{
    throw Error(m_file + ": " + m_path + field + (field.empty() ? "" : " ") + what);
}

bool Fields::has(const std::string& field)
{
    m_asked.insert(field);
    return m_json.contains(field) && !m_json.at(field).is_null();
}

const Fields::Json& Fields::at(const std::string& field, const char* allowed)
{
    if (!has(field))
        fail(field, std::string("is missing: ") + allowed);
    return m_json.at(field);
}

std::string Fields::text(const std::string& field)
{
    const Json& value = at(field, "a text");
    if (!value.is_string() || value.get<std::string>().empty())
        fail(field, "must be a text that is not empty");
    return value.get<std::string>();
}

int Fields::integer(const std::string& field)
{
    const Json& value = at(field, "a whole number");
    const double as_double = value.is_number() ? value.get<double>() : 0.5;
    if (!(std::abs(as_double) < 1e9) || as_double != std::floor(as_double))
        fail(field, "must be a whole number below 1e9, not " + shown(value));
    return int(as_double);
}

double Fields::real(const std::string& field)
{
    return real_of(at(field, "a number"), field);
}

std::vector<double> Fields::reals(const std::string& field, std::size_t count)
{
    return reals_of(at(field, "a list of numbers"), field, count);
}

std::vector<double> Fields::per_site(const std::string& field, const CfaPattern& cfa)
{
    const Json& value = at(field, "a number, or a list of them");
    if (!value.is_number() && !value.is_array())
        fail(field, "must be a number or a list of numbers, not " + shown(value));
    const std::vector<double> numbers = value.is_number()
        ? std::vector<double> { value.get<double>() }
        : reals_of(value, field, 0);
    try {
        return spread_over_sites(numbers, cfa);
    } catch (const Error& error) {
        fail(field, error.what());
    }
}

std::vector<std::array<double, 2>> Fields::pairs(const std::string& field)
{
    std::vector<std::array<double, 2>> result;
    const Json& list = at(field, "a list of [R/G, B/G]");
    if (!list.is_array())
        fail(field, "must be a list of [R/G, B/G], not " + shown(list));
    for (const Json& pair : list) {
        const auto values = reals_of(pair, field, 2);
        result.push_back({ values[0], values[1] });
    }
    return result;
}

std::vector<std::string> Fields::texts(const std::string& field)
{
    std::vector<std::string> result;
    const Json& list = at(field, "a list of texts");
    if (!list.is_array())
        fail(field, "must be a list of texts, not " + shown(list));
    for (const Json& value : list) {
        if (!value.is_string())
            fail(field, "must be a list of texts, not " + shown(list));
        result.push_back(value.get<std::string>());
    }
    return result;
}

Fields Fields::object(const std::string& field)
{
    return { at(field, "an object"), m_file, m_path + field + "." };
}

std::vector<Fields> Fields::objects(const std::string& field)
{
    const Json& list = at(field, "a list of objects");
    if (!list.is_array())
        fail(field, "must be a list, not " + shown(list));
    std::vector<Fields> result;
    for (std::size_t i = 0; i < list.size(); ++i)
        result.emplace_back(list[i], m_file,
                            m_path + field + "[" + std::to_string(i) + "].");
    return result;
}

void Fields::done() const
{
    for (const auto& [name, value] : m_json.items())
        if (!m_asked.count(name))
            fail(name,
                 "is unknown; known here: "
                     + joined({ m_asked.begin(), m_asked.end() }));
}

double Fields::real_of(const Json& value, const std::string& field) const
{
    if (!value.is_number())
        fail(field, "must be a number, not " + shown(value));
    return value.get<double>();
}

std::vector<double> Fields::reals_of(const Json& list, const std::string& field,
                                     std::size_t count) const
{
    if (!list.is_array() || (count && list.size() != count))
        fail(field,
             "must be a list of " + (count ? std::to_string(count) + " " : "")
                 + "numbers, not " + shown(list));
    std::vector<double> result;
    for (const Json& value : list)
        result.push_back(real_of(value, field));
    return result;
}

} // namespace cg2raw

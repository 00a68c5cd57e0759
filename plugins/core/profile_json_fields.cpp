// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "profile_json_fields.h"

#include "cfa.h"
#include "text.h"

#include <cmath>

namespace cg2raw {
namespace {

std::string shown(const JsonTree& value)
{
    const std::string text = value.shown();
    return text.size() > 40 ? text.substr(0, 40) + "..." : text;
}

} // namespace

Fields::Fields(const JsonTree& json, std::string file, std::string path)
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
    const JsonTree* const value = m_json.find(field);
    return value && !value->is_null();
}

const JsonTree& Fields::at(const std::string& field, const char* allowed)
{
    if (!has(field))
        fail(field, std::string("is missing: ") + allowed);
    return *m_json.find(field);
}

std::string Fields::text(const std::string& field)
{
    const JsonTree& value = at(field, "a text");
    if (!value.is_string() || value.text().empty())
        fail(field, "must be a text that is not empty");
    return value.text();
}

int Fields::integer(const std::string& field)
{
    const JsonTree& value = at(field, "a whole number");
    const double as_double = value.is_number() ? value.number() : 0.5;
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
    const JsonTree& value = at(field, "a number, or a list of them");
    if (!value.is_number() && !value.is_array())
        fail(field, "must be a number or a list of numbers, not " + shown(value));
    const std::vector<double> numbers = value.is_number()
        ? std::vector<double> { value.number() }
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
    const JsonTree& list = at(field, "a list of [R/G, B/G]");
    if (!list.is_array())
        fail(field, "must be a list of [R/G, B/G], not " + shown(list));
    for (const JsonTree& pair : list.items()) {
        const auto values = reals_of(pair, field, 2);
        result.push_back({ values[0], values[1] });
    }
    return result;
}

std::vector<std::string> Fields::texts(const std::string& field)
{
    std::vector<std::string> result;
    const JsonTree& list = at(field, "a list of texts");
    if (!list.is_array())
        fail(field, "must be a list of texts, not " + shown(list));
    for (const JsonTree& value : list.items()) {
        if (!value.is_string())
            fail(field, "must be a list of texts, not " + shown(list));
        result.push_back(value.text());
    }
    return result;
}

Fields Fields::object(const std::string& field)
{
    return { at(field, "an object"), m_file, m_path + field + "." };
}

std::vector<Fields> Fields::objects(const std::string& field)
{
    const JsonTree& list = at(field, "a list of objects");
    if (!list.is_array())
        fail(field, "must be a list, not " + shown(list));
    std::vector<Fields> result;
    for (std::size_t i = 0; i < list.items().size(); ++i)
        result.emplace_back(list.items()[i], m_file,
                            m_path + field + "[" + std::to_string(i) + "].");
    return result;
}

void Fields::done() const
{
    for (const auto& [name, value] : m_json.members())
        if (!m_asked.count(name))
            fail(name,
                 "is unknown; known here: "
                     + joined({ m_asked.begin(), m_asked.end() }));
}

double Fields::real_of(const JsonTree& value, const std::string& field) const
{
    if (!value.is_number())
        fail(field, "must be a number, not " + shown(value));
    return value.number();
}

std::vector<double> Fields::reals_of(const JsonTree& list, const std::string& field,
                                     std::size_t count) const
{
    if (!list.is_array() || (count && list.items().size() != count))
        fail(field,
             "must be a list of " + (count ? std::to_string(count) + " " : "")
                 + "numbers, not " + shown(list));
    std::vector<double> result;
    for (const JsonTree& value : list.items())
        result.push_back(real_of(value, field));
    return result;
}

} // namespace cg2raw

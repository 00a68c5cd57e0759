// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "profile_rules.h"

#include "cfa.h"
#include "text.h"

#include <algorithm>

namespace cg2raw {
namespace {

/// Of a value that JsonTree takes as it is.
template <class T, class Read, class Schema>
Rule<T> plain(const Read& read, const Schema& schema)
{
    return { read, [](const T& value) { return JsonTree(value); }, schema };
}

} // namespace

JsonTree schema_of_type(const char* type)
{
    return JsonTree::object().with("type", type);
}

JsonTree schema_of(const Bounds& bounds)
{
    JsonTree schema = schema_of_type("number");
    if (bounds.least)
        schema.set("minimum", *bounds.least);
    if (bounds.most)
        schema.set("maximum", *bounds.most);
    if (bounds.above)
        schema.set("exclusiveMinimum", *bounds.above);
    return schema;
}

JsonTree schema_of_list(JsonTree items, int least, int most)
{
    JsonTree schema = schema_of_type("array").with("items", std::move(items));
    if (least)
        schema.set("minItems", least);
    if (most)
        schema.set("maxItems", most);
    return schema;
}

JsonTree schema_of_words(const std::vector<std::string>& words)
{
    return JsonTree::object().with("enum", words);
}

JsonTree schema_of_object(JsonTree properties, JsonTree::Array required)
{
    return schema_of_type("object")
        .with("properties", std::move(properties))
        .with("required", std::move(required))
        .with("additionalProperties", false);
}

Rule<std::string> text(const char* pattern)
{
    return plain<std::string>(&Fields::text, [=] {
        return pattern ? schema_of_type("string").with("pattern", pattern)
                       : schema_of_type("string").with("minLength", 1);
    });
}

Rule<int> whole(int least, int most)
{
    Rule<int> rule = plain<int>(&Fields::integer, [=] {
        return schema_of_type("integer").with("minimum", least).with("maximum", most);
    });
    rule.fault = [=](int value) -> std::string {
        if (value >= least && value <= most)
            return {};
        return std::to_string(value) + " must be " + std::to_string(least) + " to "
            + std::to_string(most);
    };
    return rule;
}

Rule<double> real(const Bounds& bounds)
{
    Rule<double> rule = plain<double>(&Fields::real, [=] { return schema_of(bounds); });
    rule.fault = [=](double value) -> std::string {
        if (value >= bounds.least.value_or(value)
            && value <= bounds.most.value_or(value)
            && (!bounds.above || value > *bounds.above))
            return {};
        std::string words;
        for (const auto& [name, bound] :
             { std::pair("at least ", bounds.least), std::pair("above ", bounds.above),
               std::pair("at most ", bounds.most) })
            if (bound)
                words += (words.empty() ? name : std::string(" and ") + name)
                    + number(*bound);
        return number(value) + " must be " + words;
    };
    return rule;
}

Rule<std::vector<double>> reals(const Bounds& bounds)
{
    return plain<std::vector<double>>(
        [](Fields& fields, const std::string& name) { return fields.reals(name, 0); },
        [=] { return schema_of_list(schema_of(bounds), 1); });
}

Rule<std::vector<double>> per_site(const CfaPattern& cfa, const Bounds& bounds)
{
    return { [=](Fields& fields, const std::string& name) {
                return fields.per_site(name, cfa);
            },
             // Bayer keeps its four numbers; a larger repeat says no more than it must.
             [=](const std::vector<double>& sites) -> JsonTree {
                 if (cfa.width == 2)
                     return sites;
                 const std::vector<double> numbers = fewest_numbers(sites, cfa);
                 return numbers.size() == 1 ? JsonTree(numbers.front())
                                            : JsonTree(numbers);
             },
             // Of any CFA: the profile's schema says further down how many.
             [=] {
                 JsonTree::Array forms { schema_of(bounds) };
                 forms.push_back(schema_of_list(schema_of(bounds), 1, 36));
                 return JsonTree::object().with("anyOf", forms);
             } };
}

Rule<std::array<double, 2>> ratios()
{
    return plain<std::array<double, 2>>(
        [](Fields& fields, const std::string& name) {
            const auto values = fields.reals(name, 2);
            return std::array { values[0], values[1] };
        },
        [] {
            return schema_of_list(schema_of({ 0.01, 100.0 }), 2, 2);
        });
}

Rule<std::vector<std::array<double, 2>>> list_of_ratios(int least)
{
    return plain<std::vector<std::array<double, 2>>>(
        &Fields::pairs, [=] { return schema_of_list(ratios().schema(), least); });
}

Rule<Mat3> matrix()
{
    return { [](Fields& fields, const std::string& name) {
                Mat3 result {};
                const auto values = fields.reals(name, 9);
                std::copy(values.begin(), values.end(), result.m.begin());
                return result;
            },
             [](const Mat3& value) { return JsonTree(value.m); },
             [] { return schema_of_list(schema_of({}), 9, 9); } };
}

void Members::write(const char* name, JsonTree value)
{
    if (!value.is_null())
        m_to->set(name, std::move(value));
}

void Members::describe(const char* name, JsonTree schema, bool is_required)
{
    m_properties.set(name, std::move(schema));
    if (!m_groups.empty())
        m_groups.back().emplace_back(name);
    else if (is_required)
        m_required.emplace_back(name);
}

bool Members::any_of(const JsonTree& properties)
{
    bool any = false;
    for (const auto& [name, schema] : properties.members())
        any = m_from->has(name) || any;
    return any;
}

void Members::end_group()
{
    const std::vector<std::string> own = std::move(m_groups.back());
    m_groups.pop_back();
    for (const std::string& name : own) {
        std::vector<std::string> needed;
        for (const auto& group : m_groups)
            needed.insert(needed.end(), group.begin(), group.end());
        for (const std::string& other : own)
            if (other != name)
                needed.push_back(other);
        m_dependent.set(name, needed);
    }
}

JsonTree Members::schema() const
{
    JsonTree schema = schema_of_object(m_properties, m_required);
    if (!m_dependent.members().empty())
        schema.set("dependentRequired", m_dependent);
    return schema;
}

} // namespace cg2raw

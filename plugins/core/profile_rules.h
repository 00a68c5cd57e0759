// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Rules of the values in a profile's JSON; private to the core.
#pragma once

#include "profile_json_fields.h"

#include <functional>
#include <optional>
#include <utility>

namespace cg2raw {

/// Whether a field must be there.
enum class Need {
    always,
    maybe,
    of_colors, ///< maybe, and not of a monochrome sensor, which tells no colours apart
};

/// How one kind of value is read and written, and what its JSON Schema is.
template <class T> struct Rule {
    std::function<T(Fields&, const std::string& name)> read; ///< throws Error
    std::function<JsonTree(const T&)> json; ///< null: is not written
    std::function<JsonTree()> schema;
    std::function<std::string(const T&)> fault {}; ///< what is wrong with it, or empty
    Need need = Need::always;
};
template <class T> Rule<T> if_given(Rule<T> rule, Need need = Need::maybe)
{
    rule.need = need;
    return rule;
}

/// What JSON Schema calls minimum, maximum and exclusiveMinimum.
struct Bounds {
    std::optional<double> least {}, most {}, above {};
};

JsonTree schema_of_type(const char* type);
JsonTree schema_of(const Bounds& bounds);
/// @p most 0: any number of items.
JsonTree schema_of_list(JsonTree items, int least = 0, int most = 0);
JsonTree schema_of_words(const std::vector<std::string>& words);
/// Of an object that has these properties and no others.
JsonTree schema_of_object(JsonTree properties, JsonTree::Array required);

/// @p pattern : of the schema alone.
Rule<std::string> text(const char* pattern = nullptr);
Rule<int> whole(int least, int most);
Rule<double> real(const Bounds& bounds);
Rule<std::vector<double>> reals(const Bounds& bounds);
/// A number for all sites, one each for R, G and B, or one per site.
Rule<std::vector<double>> per_site(const CfaPattern& cfa, const Bounds& bounds);
/// R/G and B/G of a neutral; and a list of them.
Rule<std::array<double, 2>> ratios();
Rule<std::vector<std::array<double, 2>>> list_of_ratios(int least);
Rule<Mat3> matrix();

/// The members of an object while they are read, written or described. What describes
/// an object is a function of (Members&, object) that names each member with its rule.
class Members {
public:
    Members() = default; ///< describes
    explicit Members(Fields& from)
        : m_from(&from)
    {
    }
    /// Writes into @p to.
    explicit Members(JsonTree& to)
        : m_to(&to)
    {
    }

    template <class T> void operator()(const char* name, T& member, const Rule<T>& rule)
    {
        if (m_from)
            member = rule.read(*m_from, name);
        else if (m_to)
            write(name, rule.json(member));
        else
            describe(name, rule.schema(), rule.need == Need::always);
    }
    /// One that may be left out.
    template <class T> void maybe(const char* name, T& member, const Rule<T>& rule)
    {
        if (!m_from || m_from->has(name))
            (*this)(name, member, if_given(rule));
    }
    template <class T>
    void maybe(const char* name, std::optional<T>& member, const Rule<T>& rule)
    {
        T value = member.value_or(T {});
        const bool has = m_from ? m_from->has(name) : (!m_to || member);
        if (!has)
            return;
        (*this)(name, value, if_given(rule));
        if (m_from)
            member = std::move(value);
    }
    /// Members that are there together or not at all.
    template <class T, class Describe>
    void together(std::optional<T>& group, const Describe& describe)
    {
        if (m_to && !group)
            return;
        T value = group.value_or(T {});
        if (m_from) {
            Members names;
            describe(names, value);
            if (!any_of(names.m_properties))
                return;
        }
        m_groups.emplace_back();
        describe(*this, value);
        end_group();
        if (m_from)
            group = std::move(value);
    }
    JsonTree schema() const;

private:
    void write(const char* name, JsonTree value);
    void describe(const char* name, JsonTree schema, bool is_required);
    /// Whether one of these is given; all are known then.
    bool any_of(const JsonTree& properties);
    /// Members of the last group need each other, and those of the groups around it.
    void end_group();

    Fields* m_from = nullptr;
    JsonTree* m_to = nullptr;
    JsonTree m_properties = JsonTree::object(), m_dependent = JsonTree::object();
    JsonTree::Array m_required;
    std::vector<std::vector<std::string>> m_groups; ///< each in the one before
};

template <class T> using Describe = std::function<void(Members&, T&)>;

template <class T>
T object_from(Fields fields, const Describe<T>& describe, T value = {})
{
    Members members(fields);
    describe(members, value);
    fields.done();
    return value;
}

/// @p before : what members are that are not given.
template <class T> Rule<T> object_of(Describe<T> describe, T before = {})
{
    return { [=](Fields& fields, const std::string& name) {
                return object_from<T>(fields.object(name), describe, before);
            },
             [=](T value) {
                 JsonTree json = JsonTree::object();
                 Members members(json);
                 describe(members, value);
                 return json;
             },
             [=] {
                 T any = before;
                 Members members;
                 describe(members, any);
                 return members.schema();
             } };
}

/// None is not written. @p most 0: any number.
template <class T>
Rule<std::vector<T>> list_of(Describe<T> describe, T before = {}, int most = 0)
{
    const Rule<T> item = object_of<T>(describe, before);
    return { [=](Fields& fields, const std::string& name) {
                std::vector<T> result;
                for (Fields& row : fields.objects(name))
                    result.push_back(object_from<T>(std::move(row), describe, before));
                return result;
            },
             [=](const std::vector<T>& values) {
                 JsonTree::Array list;
                 for (const T& value : values)
                     list.push_back(item.json(value));
                 return list.empty() ? JsonTree() : JsonTree(std::move(list));
             },
             [=] { return schema_of_list(item.schema(), 0, most); } };
}

} // namespace cg2raw

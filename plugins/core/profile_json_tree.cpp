// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "profile_json_tree.h"

#include "cg2raw/types.h"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace cg2raw {

/// Puts what the parser meets into a tree.
class TreeBuilder : public nlohmann::json_sax<nlohmann::json> {
public:
    explicit TreeBuilder(JsonTree& root)
        : m_root(root)
    {
    }

    bool null() override { return add({}); }
    bool boolean(bool value) override { return add(value); }
    bool number_integer(number_integer_t value) override
    {
        return add(std::int64_t(value));
    }
    bool number_unsigned(number_unsigned_t value) override
    {
        return add(std::uint64_t(value));
    }
    bool number_float(number_float_t value, const string_t&) override
    {
        return add(double(value));
    }
    bool string(string_t& value) override { return add(std::move(value)); }
    bool binary(binary_t&) override { return false; } // JSON has none
    bool start_object(std::size_t) override
    {
        add({});
        m_last->m_value = JsonTree::Object {};
        m_open.push_back(m_last);
        return true;
    }
    bool start_array(std::size_t) override
    {
        add({});
        m_last->m_value = JsonTree::Array {};
        m_open.push_back(m_last);
        return true;
    }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }
    bool key(string_t& name) override
    {
        m_name = std::move(name);
        return true;
    }

    bool parse_error(std::size_t, const std::string&,
                     const nlohmann::json::exception& error) override
    {
        throw Error(error.what());
    }

private:
    /// What is open stays where it is: its list grows only when it is closed.
    bool add(JsonTree value)
    {
        if (m_open.empty()) {
            m_root = std::move(value);
            m_last = &m_root;
        } else if (auto* list = std::get_if<JsonTree::Array>(&m_open.back()->m_value)) {
            m_last = &list->emplace_back(std::move(value));
        } else {
            auto& members = std::get<JsonTree::Object>(m_open.back()->m_value);
            m_last = &members.emplace_back(std::move(m_name), std::move(value)).second;
        }
        return true;
    }

    bool close()
    {
        m_open.pop_back();
        return true;
    }

    JsonTree& m_root;
    JsonTree* m_last = nullptr; ///< value that was added
    std::vector<JsonTree*> m_open; ///< lists and objects, each in the one before
    std::string m_name; ///< of the member that comes next
};

JsonTree::JsonTree(bool value)
    : m_value(value)
{
}

JsonTree::JsonTree(int value)
    : m_value(std::int64_t(value))
{
}

JsonTree::JsonTree(std::int64_t value)
    : m_value(value)
{
}

JsonTree::JsonTree(std::uint64_t value)
    : m_value(value)
{
}

JsonTree::JsonTree(double value)
    : m_value(value)
{
}

JsonTree::JsonTree(const char* value)
    : m_value(std::string(value))
{
}

JsonTree::JsonTree(std::string value)
    : m_value(std::move(value))
{
}

JsonTree::JsonTree(Array value)
    : m_value(std::move(value))
{
}

JsonTree::JsonTree(const std::map<std::string, double>& values)
    : m_value(Object(values.begin(), values.end()))
{
}

JsonTree JsonTree::object()
{
    JsonTree json;
    json.m_value = Object();
    return json;
}

JsonTree JsonTree::with(std::string_view name, JsonTree value) &&
{
    set(name, std::move(value));
    return std::move(*this);
}

JsonTree JsonTree::parse(std::string_view text)
{
    JsonTree json;
    TreeBuilder builder(json);
    nlohmann::json::sax_parse(text, &builder);
    return json;
}

bool JsonTree::is_number() const
{
    return is<std::int64_t>() || is<std::uint64_t>() || is<double>();
}

template <class T> const T& JsonTree::get() const
{
    if (const T* value = std::get_if<T>(&m_value))
        return *value;
    throw Error("a value of JSON is of another kind: " + shown());
}

double JsonTree::number() const
{
    if (is<std::int64_t>())
        return double(get<std::int64_t>());
    return is<std::uint64_t>() ? double(get<std::uint64_t>()) : get<double>();
}

template const std::string& JsonTree::get() const;
template const JsonTree::Array& JsonTree::get() const;
template const JsonTree::Object& JsonTree::get() const;

const JsonTree* JsonTree::find(std::string_view name) const
{
    for (const auto& [key, value] : members())
        if (key == name)
            return &value;
    return nullptr;
}

void JsonTree::set(std::string_view name, JsonTree value)
{
    auto& members = std::get<Object>(m_value);
    const auto found
        = std::find_if(members.begin(), members.end(),
                       [&](const auto& member) { return member.first == name; });
    if (found != members.end())
        found->second = std::move(value);
    else
        members.emplace_back(name, std::move(value));
}

void JsonTree::update(const JsonTree& other)
{
    for (const auto& [name, value] : other.members())
        set(name, value);
}

std::string JsonTree::shown() const
{
    std::string out;
    write(out, Layout::shown, 0);
    return out;
}

std::string JsonTree::dump(bool is_short) const
{
    std::string out;
    write(out, is_short ? Layout::one_line : Layout::lines, 0);
    return out;
}

namespace {

/// A value that holds no others, as nlohmann writes it.
template <class T> std::string scalar(const T& value, bool is_shown)
try {
    using Handler = nlohmann::json::error_handler_t;
    return nlohmann::json(value).dump(-1, ' ', is_shown,
                                      is_shown ? Handler::replace : Handler::strict);
} catch (const nlohmann::json::exception& error) {
    throw Error(error.what());
}

} // namespace

void JsonTree::write(std::string& out, Layout layout, std::size_t depth) const
{
    const bool is_shown = layout == Layout::shown;
    const auto next = [&](const char* before, std::size_t deep) {
        out += before;
        if (layout == Layout::lines)
            out += '\n' + std::string(2 * deep, ' ');
    };
    const auto each = [&](const auto& list, const char* brackets, const auto& put) {
        out += brackets[0];
        for (std::size_t i = 0; i < list.size(); ++i) {
            next(i ? "," : "", depth + 1);
            put(list[i]);
        }
        if (!list.empty())
            next("", depth);
        out += brackets[1];
    };
    const auto put_value
        = [&](const JsonTree& value) { value.write(out, layout, depth + 1); };
    if (is_array())
        return each(items(), "[]", put_value);
    if (is_object())
        return each(members(), "{}", [&](const auto& member) {
            out += scalar(member.first, is_shown);
            out += layout == Layout::lines ? ": " : ":";
            put_value(member.second);
        });
    std::visit(
        [&](const auto& value) {
            using T = std::decay_t<decltype(value)>;
            if constexpr (std::is_same_v<T, Null>)
                out += "null";
            else if constexpr (!std::is_same_v<T, Array> && !std::is_same_v<T, Object>)
                out += scalar(value, is_shown);
        },
        m_value);
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file A JSON document in memory, in the order of its text.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace cg2raw {

/// A value of JSON. It takes no memory to be destroyed, as nlohmann's does: where
/// memory ends, an exception passes through its scope, and not the end of the process.
class JsonTree {
public:
    using Array = std::vector<JsonTree>;
    using Object = std::vector<std::pair<std::string, JsonTree>>; ///< in their order
    /// What is copied by its own function makes a variant one whose copy may fail, as
    /// it may without memory: libstdc++ 12 destroys what it has not made of others.
    struct Null {
        Null() = default;
        Null(const Null&) noexcept { }
        Null& operator=(const Null&) noexcept { return *this; }
    };

    JsonTree() = default; ///< null
    JsonTree(bool value);
    JsonTree(int value);
    JsonTree(std::int64_t value);
    JsonTree(std::uint64_t value);
    JsonTree(double value);
    JsonTree(const char* value);
    JsonTree(std::string value);
    JsonTree(Array value);
    /// Lists of what can be a value itself.
    template <class T>
    JsonTree(const std::vector<T>& values)
        : JsonTree(Array(values.begin(), values.end()))
    {
    }
    template <class T, std::size_t count>
    JsonTree(const std::array<T, count>& values)
        : JsonTree(Array(values.begin(), values.end()))
    {
    }
    JsonTree(const std::map<std::string, double>& values);

    static JsonTree object(); ///< without members
    /// It with one more member, an object.
    JsonTree with(std::string_view name, JsonTree value) &&;
    /// Throws Error that says what is wrong and where.
    static JsonTree parse(std::string_view text);

    bool is_null() const { return is<Null>(); }
    bool is_number() const;
    bool is_string() const { return is<std::string>(); }
    bool is_array() const { return is<Array>(); }
    bool is_object() const { return is<Object>(); }

    /// The value as a double, a text, or with what it holds, if it is one; else Error.
    double number() const;
    const std::string& text() const { return get<std::string>(); }
    const Array& items() const { return get<Array>(); }
    const Object& members() const { return get<Object>(); }
    /// The member @p name of an object; null if there is none.
    const JsonTree* find(std::string_view name) const;

    /// Sets a member of an object, in the place of one of this name.
    void set(std::string_view name, JsonTree value);
    /// Sets all members of @p other, an object.
    void update(const JsonTree& other);

    /// In one line without blanks; as ASCII with escapes and, in the place of bytes
    /// that are no UTF-8, U+FFFD. Any text can so be shown.
    std::string shown() const;
    /// Each member on a line of its own, two blanks deeper than what it is in; or, with
    /// @p is_short, in one line without blanks. Throws Error for a text that is no
    /// UTF-8.
    std::string dump(bool is_short = false) const;

private:
    friend class TreeBuilder;
    enum class Layout { lines, one_line, shown };

    template <class T> bool is() const { return std::holds_alternative<T>(m_value); }
    template <class T> const T& get() const;
    void write(std::string& out, Layout layout, std::size_t depth) const;

    std::variant<Null, bool, std::int64_t, std::uint64_t, double, std::string, Array,
                 Object>
        m_value;
};

} // namespace cg2raw

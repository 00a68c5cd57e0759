// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "profile_syntax.h"

#include "platform/numbers.h"
#include "text.h"

#include <nlohmann/json.hpp>

#include <set>
#include <vector>

namespace cg2raw {
namespace {

using Json = nlohmann::ordered_json;

/// Counts what the parser meets, and keeps nothing but the names of open objects.
class SyntaxCheck : public nlohmann::json_sax<Json> {
public:
    explicit SyntaxCheck(std::string file)
        : m_file(std::move(file))
    {
    }

    bool null() override { return value(); }
    bool boolean(bool) override { return value(); }
    bool number_integer(number_integer_t) override { return value(); }
    bool number_unsigned(number_unsigned_t) override { return value(); }
    bool number_float(number_float_t, const string_t&) override { return value(); }
    bool string(string_t&) override { return value(); }
    bool binary(binary_t&) override { return value(); }
    bool start_object(std::size_t) override { return open(); }
    bool start_array(std::size_t) override { return open(); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }

    bool key(string_t& name) override
    {
        auto& names = m_open.back();
        if (!names.insert(name).second)
            fail(quotable(name) + " is there twice; each field may be given once");
        if (names.size() > most_profile_fields)
            fail(quotable(name) + " is one field too many: an object has up to "
                 + std::to_string(most_profile_fields));
        return true;
    }

    bool parse_error(std::size_t, const std::string&,
                     const nlohmann::json::exception& error) override
    {
        fail("is no JSON: " + quotable(error.what()));
    }

private:
    [[noreturn]] void fail(const std::string& what) const
    {
        throw Error(m_file + ": " + what);
    }

    bool value()
    {
        if (++m_values > most_profile_values)
            fail("has more than " + std::to_string(most_profile_values)
                 + " values, too many for a sensor profile");
        return true;
    }

    bool open()
    {
        m_open.emplace_back();
        if (m_open.size() > most_profile_depth)
            fail("has more than " + std::to_string(most_profile_depth)
                 + " lists and objects in each other, too many for a sensor profile");
        return value();
    }

    bool close()
    {
        m_open.pop_back();
        return true;
    }

    std::string m_file;
    std::size_t m_values = 0;
    std::vector<std::set<std::string>> m_open; ///< field names; empty for a list
};

} // namespace

void check_profile_size(std::uintmax_t size, const std::string& file)
{
    if (size > largest_profile)
        throw Error(file + ": " + std::to_string(size)
                    + " bytes are too many for a sensor profile (16 MiB at most)");
}

void check_profile_syntax(std::string_view json, const std::string& file)
{
    check_profile_size(json.size(), file);
    SyntaxCheck check(file);
    Json::sax_parse(json, &check);
}

} // namespace cg2raw

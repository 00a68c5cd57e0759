// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The fields of a JSON object in a sensor profile, each asked for by its name.
#pragma once

#include "cg2raw/profile.h"
#include "profile_json_tree.h"

#include <array>
#include <set>
#include <string>
#include <vector>

namespace cg2raw {

/// A JSON object that knows its file and path, and which of its fields were asked for.
/// What reads a field throws Error, naming file, path and value, if it is not there or
/// is something else.
class Fields {
public:
    /// Keeps a reference to @p json. Throws Error unless that is an object.
    Fields(const JsonTree& json, std::string file, std::string path);

    [[noreturn]] void fail(const std::string& field, const std::string& what) const;

    bool has(const std::string& field);
    const JsonTree& at(const std::string& field, const char* allowed);
    std::string text(const std::string& field);
    int integer(const std::string& field);
    double real(const std::string& field);
    /// @p count numbers; 0: any count.
    std::vector<double> reals(const std::string& field, std::size_t count);
    /// One number per site of @p cfa; the file may say one for all, or one per colour.
    std::vector<double> per_site(const std::string& field, const CfaPattern& cfa);
    std::vector<std::array<double, 2>> pairs(const std::string& field);
    std::vector<std::string> texts(const std::string& field);
    Fields object(const std::string& field);
    std::vector<Fields> objects(const std::string& field);

    const JsonTree& json() const { return m_json; }

    /// Fields that nobody asked for are errors.
    void done() const;

private:
    double real_of(const JsonTree& value, const std::string& field) const;
    std::vector<double> reals_of(const JsonTree& list, const std::string& field,
                                 std::size_t count) const;

    const JsonTree& m_json;
    std::string m_file, m_path;
    std::set<std::string> m_asked;
};

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Whether several DNGs are of one camera, and if not, which is of which.
#include "reader/profile_parts.h"
#include "tiff/tag_numbers.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace cg2raw {
namespace {

/// Matrices are rationals of at least 1/10000 in most files: one step is rounding.
constexpr double matrix_step = 1.0001e-4;
/// File names that a message lists of one group.
constexpr std::size_t most_names = 3;

std::string listed(const std::vector<std::string>& files)
{
    std::string text;
    for (std::size_t i = 0; i < std::min(files.size(), most_names); ++i)
        text += (i ? ", " : "") + files[i];
    if (files.size() > most_names)
        text += " and " + std::to_string(files.size() - most_names) + " more";
    return text;
}

/// By what each of them says: the value, and the files that say so, in their order.
using Groups = std::vector<std::pair<std::string, std::vector<std::string>>>;

template <class Say> Groups grouped(const std::vector<DngMetadata>& files, Say say)
{
    Groups groups;
    for (const DngMetadata& file : files) {
        const std::string value = say(file);
        auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& known) {
            return known.first == value;
        });
        if (group == groups.end())
            group = groups.insert(groups.end(), { value, {} });
        group->second.push_back(file.file);
    }
    return groups;
}

/// Throws Error that lists the groups, if there are several.
template <class Say>
void check_same(const std::vector<DngMetadata>& files, const std::string& what,
                const std::string& remedy, Say say)
{
    const Groups groups = grouped(files, say);
    if (groups.size() == 1)
        return;
    std::string text;
    for (const auto& [value, names] : groups)
        text += (text.empty() ? "" : "; ") + value + ": " + listed(names);
    throw Error(files.front().file + ": " + what + " is not the same in all files ("
                + text + "): " + remedy);
}

std::vector<Calibration> by_temperature(std::vector<Calibration> calibrations)
{
    std::sort(calibrations.begin(), calibrations.end(),
              [](const auto& a, const auto& b) {
                  const auto key = [](const Calibration& c) {
                      return std::pair(light_source_temperature(c.light_source).value,
                                       c.light_source);
                  };
                  return key(a) < key(b);
              });
    return calibrations;
}

double largest_difference(const Mat3& a, const Mat3& b)
{
    double largest = 0.0;
    for (std::size_t i = 0; i < 9; ++i)
        largest = std::max(largest, std::abs(a.m[i] - b.m[i]));
    return largest;
}

/// What differs between the calibrations of two files; empty: nothing.
std::string difference(const DngMetadata& a, const DngMetadata& b)
{
    const auto first = by_temperature(a.calibrations);
    const auto second = by_temperature(b.calibrations);
    if (first.size() != second.size())
        return "the number of matrices";
    for (std::size_t i = 0; i < first.size(); ++i) {
        const std::string light = light_source_name(first[i].light_source);
        if (first[i].light_source != second[i].light_source)
            return "CalibrationIlluminant (" + light + " and "
                + light_source_name(second[i].light_source) + ")";
        const double color
            = largest_difference(first[i].camera_from_xyz, second[i].camera_from_xyz);
        if (color > matrix_step)
            return "ColorMatrix for " + light + " (by up to " + rounded_text(color)
                + ", CameraCalibration folded in)";
        const auto &x = first[i].xyz_d50_from_camera,
                   &y = second[i].xyz_d50_from_camera;
        if (x.has_value() != y.has_value()
            || (x && largest_difference(*x, *y) > matrix_step))
            return "ForwardMatrix for " + light;
    }
    return {};
}

void check_same_matrices(const std::vector<DngMetadata>& files)
{
    const DngMetadata& first = files.front();
    std::vector<std::string> others;
    std::string what;
    for (const DngMetadata& file : files) {
        const std::string differs = difference(first, file);
        if (differs.empty())
            continue;
        what = what.empty() ? differs : what;
        others.push_back(file.file);
    }
    if (!others.empty())
        throw Error(first.file + ": " + what + " is not the same in " + listed(others)
                    + ": firmwares or bodies differ; make a profile of each");
}

} // namespace

void check_one_camera(const std::vector<DngMetadata>& files)
{
    check_same(files, "the camera", "make a profile of each", [](const auto& file) {
        return camera_name(file) + " (Make " + file.make + ", Model " + file.model
            + ")";
    });
    check_same(files, "the size of the active area",
               "crops of one camera are sensors of their own here; make a profile of"
               " each",
               [](const auto& file) {
                   return std::to_string(file.active_area.width) + " x "
                       + std::to_string(file.active_area.height);
               });
    check_same(files, text_of(tag::cfa_pattern), "make a profile of each",
               [](const auto& file) { return name_of(file.cfa); });
    check_same(files, text_of(tag::white_level),
               "cameras have several by ISO or mode; make a profile of each",
               [](const auto& file) { return std::to_string(file.white_level); });
    check_same_matrices(files);
}

} // namespace cg2raw

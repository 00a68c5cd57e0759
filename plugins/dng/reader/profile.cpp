// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The sensor profile that DNGs of one camera amount to.
#include "platform/paths.h"
#include "reader/profile_parts.h"
#include "tiff/tag_numbers.h"
#include "tiff/text.h"

#include <algorithm>
#include <charconv>

namespace cg2raw {
namespace {

/// The files' notes, each once; what only some of them say says so.
Notes merged_notes(const std::vector<DngMetadata>& files)
{
    std::vector<std::pair<std::string, std::size_t>> counted;
    for (const DngMetadata& file : files)
        for (const std::string& note : file.notes) {
            const auto known
                = std::find_if(counted.begin(), counted.end(),
                               [&](const auto& entry) { return entry.first == note; });
            if (known == counted.end())
                counted.emplace_back(note, 1);
            else
                ++known->second;
        }
    Notes notes;
    for (const auto& [note, count] : counted)
        notes.push_back(count >= files.size() ? note
                                              : note + " (in " + std::to_string(count)
                                + " of " + std::to_string(files.size()) + " files)");
    return notes;
}

std::vector<std::pair<std::string, std::string>>
sources_of(const SensorProfile& profile, const std::string& files, const Notes& notes)
{
    std::vector<std::pair<std::string, std::string>> sources {
        { "levels, CFA and size", files + ": raw IFD" },
    };
    if (!profile.calibrations.empty())
        sources.push_back({ "color_matrix",
                            files
                                + ": ColorMatrix with AnalogBalance and "
                                  "CameraCalibration folded in" });
    if (!profile.illuminants.neutrals.empty())
        sources.push_back(
            { "illuminants",
              files + ": AsShotNeutral, or AsShotWhiteXY through the matrices" });
    if (profile.digital_gain)
        sources.push_back(
            { "digital_gain", files + ": 2 to the power of BaselineExposure" });
    if (!profile.noise.empty())
        sources.push_back({ "noise", files + ": NoiseProfile at the file's ISO" });
    if (!profile.effects.empty())
        sources.push_back({ "effects", files + ": GainMaps of OpcodeList2" });
    for (std::size_t i = 0; i < notes.size(); ++i)
        sources.push_back({ "note " + std::to_string(i + 1), notes[i] });
    return sources;
}

/// @p given if it is legal, else what the camera's name gives.
std::string checked_id(const std::string& given, const DngMetadata& metadata)
{
    const std::string fault = given.empty() ? "" : sensor_id_fault(given);
    if (!fault.empty())
        throw Error(metadata.file + ": id " + fault);
    const std::string name = camera_name(metadata);
    const std::string id = given.empty() ? sensor_id_from_name(name) : given;
    if (id.empty())
        throw Error(metadata.file + ": " + text_of(tag::unique_camera_model) + " \""
                    + name
                    + "\" must have a letter or digit of ASCII, for the sensor's id");
    return id;
}

} // namespace

std::string camera_name(const DngMetadata& metadata)
{
    return metadata.unique_camera_model.empty()
        ? camera_name(metadata.make, metadata.model)
        : metadata.unique_camera_model;
}

std::string camera_name(const std::string& make, const std::string& model)
{
    const std::size_t begin = std::min(make.find_first_not_of(' '), make.size());
    const std::string brand = make.substr(begin, make.find(' ', begin) - begin);
    const std::string first = model.substr(0, model.find_first_of(" -_", brand.size()));
    if (sensor_id_from_name(first) == sensor_id_from_name(brand))
        return model;
    return brand.empty() || model.empty() ? brand + model : brand + " " + model;
}

std::string names_of_files(const std::vector<DngMetadata>& files)
{
    const auto name = [](const DngMetadata& metadata) {
        return printable_text(utf8_of(path_of(metadata.file).filename()));
    };
    if (files.size() == 1)
        return name(files.front());
    return std::to_string(files.size()) + " DNGs, " + name(files.front()) + " to "
        + name(files.back());
}

std::string rounded_text(double value)
{
    char text[40];
    return { text,
             std::to_chars(text, text + sizeof text, value, std::chars_format::general,
                           4)
                 .ptr };
}

std::string sensor_id_from_name(std::string_view name)
{
    std::string id;
    bool gap = false;
    for (char c : name) {
        const bool upper = c >= 'A' && c <= 'Z';
        if (!upper && !(c >= 'a' && c <= 'z') && !(c >= '0' && c <= '9')) {
            gap = true;
            continue;
        }
        if (gap && !id.empty())
            id += '-';
        gap = false;
        id += upper ? char(c - 'A' + 'a') : c;
    }
    id.resize(std::min(id.size(), longest_sensor_id));
    while (!id.empty() && id.back() == '-')
        id.pop_back();
    return id;
}

ProfileOfDngs profile_from_dngs(const std::vector<DngMetadata>& files,
                                const std::string& id)
{
    if (files.empty())
        throw Error(
            "profile of DNGs: no file is given; give one or more of one camera");
    check_one_camera(files);
    const DngMetadata& first = files.front();
    const std::string name = camera_name(first);
    Notes notes = merged_notes(files);
    SensorProfile profile {};
    profile.id = checked_id(id, first);
    profile.make = first.make.empty() ? name.substr(0, name.find(' ')) : first.make;
    profile.model = first.model.empty() ? name : first.model;
    profile.unique_camera_model = name;
    profile.cfa = first.cfa;
    profile.width = first.active_area.width;
    profile.height = first.active_area.height;
    profile.bits = first.bits;
    profile.black_level = merged_black_level(files, notes);
    profile.white_level = first.white_level;
    profile.calibrations = first.calibrations;
    profile.illuminants = merged_neutrals(files, notes);
    profile.digital_gain = measured_digital_gain(files);
    profile.noise = merged_noise(files, notes);
    profile.effects = shading_of(files, notes);
    profile.sources = sources_of(profile, names_of_files(files), notes);
    check(profile, first.file);
    return { profile, notes };
}

SensorProfile profile_from_dng(const DngMetadata& metadata)
{
    if (!metadata.as_shot_neutral && !metadata.cfa.is_mono())
        throw Error(metadata.file + ": " + text_of(tag::as_shot_neutral)
                    + " is missing; a reference must"
                      " say its neutral: use another DNG of this camera");
    // Not from a list of one, which would copy the maps twice.
    return profile_from_dngs(std::vector<DngMetadata>(1, metadata)).profile;
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The sensor profile that one reference DNG amounts to.
#include "cg2raw/dng_reader.h"

#include <filesystem>

namespace cg2raw {
namespace {

/// What people call the camera: make and model, the make not said twice.
std::string full_name(const DngMetadata& metadata)
{
    if (!metadata.unique_camera_model.empty())
        return metadata.unique_camera_model;
    const std::string make = metadata.make.substr(0, metadata.make.find(' '));
    const bool said = sensor_id_from_name(metadata.model.substr(0, make.size()))
        == sensor_id_from_name(make);
    return said ? metadata.model : make + " " + metadata.model;
}

NoiseAtIso noise_of(const DngMetadata& metadata)
{
    NoiseAtIso noise { double(*metadata.shot.iso), {}, {} };
    for (int site = 0; site < metadata.cfa.sites(); ++site) {
        const auto plane = std::size_t(metadata.cfa.colors[std::size_t(site)]);
        noise.beta1.push_back(metadata.noise_profile[plane].scale);
        noise.beta2.push_back(metadata.noise_profile[plane].offset);
    }
    return noise;
}

std::vector<std::pair<std::string, std::string>> sources_of(const DngMetadata& metadata)
{
    const std::string file = std::filesystem::path(metadata.file).filename().string();
    std::vector<std::pair<std::string, std::string>> sources {
        { "levels, CFA and size", file + ": raw IFD" },
        { "color_matrix",
          file + ": ColorMatrix with AnalogBalance and CameraCalibration folded in" },
        { "illuminants",
          file + ": AsShotNeutral, or AsShotWhiteXY through the matrices" },
    };
    if (!metadata.noise_profile.empty() && metadata.shot.iso)
        sources.push_back({ "noise", file + ": NoiseProfile at the file's ISO" });
    for (std::size_t i = 0; i < metadata.notes.size(); ++i)
        sources.push_back({ "note " + std::to_string(i + 1), metadata.notes[i] });
    return sources;
}

} // namespace

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
    return id;
}

SensorProfile profile_from_dng(const DngMetadata& metadata)
{
    const std::string name = full_name(metadata);
    SensorProfile profile {};
    profile.id = sensor_id_from_name(name);
    if (profile.id.empty())
        throw Error(metadata.file + ": UniqueCameraModel (50708) \"" + name
                    + "\" must have a letter or digit of ASCII, for the sensor's id");
    if (!metadata.as_shot_neutral)
        throw Error(metadata.file
                    + ": AsShotNeutral (50728) is missing; a reference must"
                      " say its neutral: use another DNG of this camera");
    profile.make
        = metadata.make.empty() ? name.substr(0, name.find(' ')) : metadata.make;
    profile.model = metadata.model.empty() ? name : metadata.model;
    profile.unique_camera_model = name;
    profile.sources = sources_of(metadata);
    profile.cfa = metadata.cfa;
    profile.width = metadata.active_area.width;
    profile.height = metadata.active_area.height;
    profile.bits = metadata.bits;
    profile.black_level = metadata.black_level;
    profile.white_level = metadata.white_level;
    profile.calibrations = metadata.calibrations;
    const Vec3& neutral = *metadata.as_shot_neutral;
    profile.illuminants = distribution_of({ { neutral[0], neutral[2] } });
    if (!metadata.noise_profile.empty() && metadata.shot.iso)
        profile.noise.push_back(noise_of(metadata));
    check(profile, metadata.file);
    return profile;
}

} // namespace cg2raw

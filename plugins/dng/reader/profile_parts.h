// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The parts that profile_from_dngs() is made of; private to it.
#pragma once

#include "cg2raw/dng_reader.h"

namespace cg2raw {

using Notes = std::vector<std::string>;

/// As raw converters look it up, or camera_name() of its make and model.
std::string camera_name(const DngMetadata& metadata);
/// "a.dng", or "12 DNGs, a.dng to z.dng": names without folders, fit for JSON.
std::string names_of_files(const std::vector<DngMetadata>& files);
/// As people write it: up to four significant digits.
std::string rounded_text(double value);

/// Throws Error, naming files, unless all are of one camera, size, CFA, white level and
/// set of matrices.
void check_one_camera(const std::vector<DngMetadata>& files);

/// The mean, exact where all are equal.
double mean_of(const std::vector<double>& values);

/// Mean black level per CFA site. Throws Error if files differ by more than they may.
std::vector<double> merged_black_level(const std::vector<DngMetadata>& files,
                                       Notes& notes);
/// One row per ISO of the files that have noise and ISO.
std::vector<NoiseAtIso> merged_noise(const std::vector<DngMetadata>& files,
                                     Notes& notes);
/// How much darker files are than they are shown: 2^BaselineExposure of those that
/// state one.
std::optional<DigitalGain> measured_digital_gain(const std::vector<DngMetadata>& files);
/// The neutrals of all files that have one, in their order.
NeutralDistribution merged_neutrals(const std::vector<DngMetadata>& files,
                                    Notes& notes);

/// The effects lens_shading and color_shading that fit the files' GainMaps best;
/// without one that is null or that the maps cannot be.
std::vector<EffectSetting> shading_of(const std::vector<DngMetadata>& files,
                                      Notes& notes);

} // namespace cg2raw

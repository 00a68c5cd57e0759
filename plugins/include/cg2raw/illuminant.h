// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file 2 - Name or draw an illuminant; hence the neutral, its chromaticity, its
/// matrix.
#pragma once

#include "cg2raw/profile.h"

namespace cg2raw {

/// The grammar, one line, for messages and help.
extern const char* const illuminant_grammar;

/// A light as one sensor sees it.
struct Illuminant {
    std::string spec; ///< the word that named it
    std::string sensor; ///< id of the profile that sees it so
    Vec3 neutral; ///< camera RGB of a neutral patch, G = 1 (AsShotNeutral), at 1e-6
    Chromaticity xy; ///< as a raw converter derives it from the neutral
    Temperature temperature; ///< of xy, Adobe's table
};

/// The illuminant that @p spec names ("A", "D65", "3200K", "xy:0.3457:0.3585",
/// "neutral:0.55:0.45", "sample:7", "measured:7", "as-shot", "FL2" or "lamp:my-lamp",
/// lamps that the profile lists; the name of such a lamp comes before its other
/// meanings); @p as_shot is the reference DNG's neutral, if there is one. sample:n and
/// measured:n are pure functions of profile and n. A monochrome sensor sees 1 of each
/// light, needs no word, and has nothing to sample. Throws Error that lists the
/// grammar.
Illuminant illuminant(const SensorProfile& profile, std::string_view spec,
                      const std::optional<Vec3>& as_shot = std::nullopt);

/// @p profile with the matrix of the lamp that @p spec names as its only calibration;
/// as it is for the words of other lights.
SensorProfile calibrated_for(const SensorProfile& profile, std::string_view spec);

/// Relative power of a light, and what it is called in messages.
struct LightSpectrum {
    Spectrum power;
    std::string name; ///< "FL2", "black body of 3200 K", "half FL2, half D6500 K"
};
/// Spectrum of a light that @p profile sees: of its lamp's power, or of what the word
/// names; of a word for a neutral or a chromaticity the nearest of black bodies,
/// daylight and lamps, or of their mixtures, as the sensor sees them. Throws Error for
/// a sensor without sensitivities.
LightSpectrum spectrum_of(const SensorProfile& profile, const Illuminant& light);

/// "A,D65,sample:0-9" -> its single words. Throws Error on a word that names none, and
/// for more than 100000 words.
std::vector<std::string> illuminant_list(std::string_view list);

/// What a raw converter makes of a neutral: fixed point of
/// xy <- chromaticity(M(T(xy))^-1 neutral), from D50, at most 30 passes; a file that
/// does not converge gets the mean of the last two. Source: DNG specification 1.7,
/// chapter 6.
struct NeutralChromaticity {
    Chromaticity xy;
    int passes;
    bool converged;
};
NeutralChromaticity xy_from_neutral(const SensorProfile& profile, const Vec3& neutral);

/// Weight of the warmer calibration at @p xy, linear in 1/T, clamped to 0..1.
double warm_weight(const SensorProfile& profile, Chromaticity xy);
/// The profile's ColorMatrix at the temperature of @p xy, scaled and rounded to 1/10000
/// as raw converters do.
Mat3 camera_from_xyz(const SensorProfile& profile, Chromaticity xy);
/// ForwardMatrix at the temperature of @p xy; nothing if a calibration has none.
std::optional<Mat3> xyz_d50_from_camera(const SensorProfile& profile, Chromaticity xy);

/// "RAW - <sensor> - <illuminant>" or its alias raw_<sensor>_<illuminant>, in any
/// namespace ("cg2raw:raw_..."); so is "RAW
/// unbounded - ..." (raw_unbounded_...). "RAW - context" (raw_context), or unbounded,
/// is what $CG2RAW_SENSOR and $CG2RAW_ILLUMINANT say.
struct RawSpace {
    std::string sensor, illuminant;
};
/// What a colour space's name says; nothing if it is not the name of a RAW space.
/// Aliases are resolved against @p sensors. Throws Error if it starts like one but
/// names no sensor or illuminant.
std::optional<RawSpace> raw_space_from_name(std::string_view name,
                                            const std::vector<std::string>& sensors);
std::string raw_space_name(const RawSpace& space);
std::string raw_space_alias(const RawSpace& space);
/// What a config calls it in files: its alias in the namespace cg2raw.
std::string raw_space_interop_id(const RawSpace& space);
/// The colour space of a file: @p space, unless it is only what OpenImageIO 2 says of
/// any EXR, "Linear", and the file's own @p interop_id is of a RAW space.
std::string space_of_file(std::string_view space, std::string_view interop_id);

} // namespace cg2raw

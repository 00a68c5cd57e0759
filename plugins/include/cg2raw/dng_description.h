// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What a DNG says of its camera, its shot and its pixels, whether it is read or
/// written.
#pragma once

#include "cg2raw/profile.h"
#include "cg2raw/time_code.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace cg2raw {

/// Noise of one colour plane as NoiseProfile has it: sd = sqrt(scale x + offset), x in
/// 0..1.
struct NoisePair {
    double scale, offset;
};

/// Gains that undo lens shading, on a regular grid over the active area, one map for
/// all sites. Row major.
struct GainMap {
    int rows, cols;
    std::vector<float> gains;
};

/// How an exposure was chosen. Source: Exif 2.3 (CIPA DC-008-2012), ExposureMode.
enum class ExposureMode { automatic = 0, manual = 1, bracket = 2 };

/// What Exif says of the exposure, and CinemaDNG of the frame's place in a shot; absent
/// fields are not written.
struct Shot {
    std::optional<double> exposure_time; ///< s
    std::optional<double> f_number;
    std::optional<double> focal_length; ///< mm
    std::optional<int> iso;
    std::optional<double> exposure_bias; ///< stops
    std::optional<ExposureMode> exposure_mode;
    std::optional<double> brightness; ///< APEX, stops
    std::string date_time_original; ///< "YYYY:MM:DD HH:MM:SS" or empty
    std::string artist, copyright, description, lens_model;
    int orientation = 1; ///< Exif orientation, 1 to 8
    std::optional<FrameRate> frame_rate; ///< makes it a frame of a shot
    std::optional<TimeCode> time_code;
    std::string reel_name, camera_label;
    std::optional<double> pixel_aspect; ///< width of a pixel over its height
};

/// Bounds of Shot::pixel_aspect, far beyond what lenses and video formats have.
constexpr double least_pixel_aspect = 0.01, most_pixel_aspect = 100.0;

/// Bounds of Shot::exposure_bias and brightness, either way.
constexpr double most_exif_stops = 1e4;

/// Whether a file is a frame of a shot, as CinemaDNG has it: one that says how many of
/// them a second has.
inline bool is_of_shot(const Shot& shot) { return shot.frame_rate.has_value(); }

/// None of a number that Exif has no mode for.
std::optional<ExposureMode>
exposure_mode_from_number(const std::optional<double>& number);

/// Without what makes no sense in Exif: dates of another form, orientations but 1 to 8,
/// numbers outside 1e-6 to 1e6, pixels of other shapes; and without a time code at a
/// rate that has none. It is no reason to refuse a picture.
Shot plausible(Shot shot);

/// How a simulation made a file, for its XMP; what is empty is not said. A text is cut
/// off behind 256 bytes.
struct Origin {
    std::string sensor; ///< id of the profile
    std::string illuminant; ///< the word that named the light
    std::optional<double> temperature; ///< of the light, K
    std::optional<double> iso;
    std::string convention;
    std::optional<double> exposure; ///< stops by which scene-linear values were changed
    std::string exposure_rule; ///< the words that decided it
    std::optional<double> digital_gain;
    std::optional<std::uint64_t> seed;
    std::optional<std::int64_t> frame;
    std::vector<std::string> effects; ///< names, in the order of application
};

/// All that a file says of its pixels.
struct DngDescription {
    Size size; ///< of the active area, which is the whole mosaic
    /// Repeats of 2x2 and 6x6 are demosaicked by LibRaw, dcraw, RawTherapee and
    /// darktable; of 4x4 by none of them, though LibRaw reads its DN. A monochrome
    /// sensor's file is LinearRaw of one sample.
    CfaPattern cfa;
    /// DN per CFA site. Levels that differ on 6x6 are subtracted by LibRaw and dcraw;
    /// RawTherapee 5.9 and darktable 4.2 know no more than 2x2 of them.
    std::vector<double> black_level;
    int white_level; ///< DN
    std::vector<Calibration> calibrations; ///< none of a monochrome sensor
    Vec3 as_shot_neutral; ///< G = 1; 1, 1, 1 of a monochrome sensor
    std::string make, model, unique_camera_model;
    std::vector<NoisePair>
        noise_profile; ///< empty, or one per colour plane: R, G, B, or one
    /// Against lens_shading and color_shading, per colour R, G, B; alike if monochrome.
    std::optional<std::array<GainMap, 3>> shading_gains;
    Mat3 srgb_from_balanced; ///< for the preview
    Shot shot;
    Origin origin;
};

} // namespace cg2raw

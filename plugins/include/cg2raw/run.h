// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What one exposure is asked to be.
#pragma once

#include "cg2raw/transform.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cg2raw {

/// How the noise of an ISO is drawn; its variance is the same in both.
enum class NoiseModel {
    gaussian, ///< shot_noise and read_noise
    physical, ///< poisson_shot_noise, heavy_tailed_noise and row_noise: needs an ISO
};
/// "gaussian" or "physical". Throws Error on other words.
NoiseModel noise_model_from_name(std::string_view name);
const char* name_of(NoiseModel model);

/// Bounds of what is found, both included.
struct Limits {
    double low, high;
};

/// Probability and stops; both rise.
using Quantiles = std::vector<std::array<double, 2>>;

/// How bright a scene is exposed, in stops on its scene-linear values.
struct ExposureRule {
    enum class Kind {
        stops, ///< first
        meter, ///< the luminance of percentile first becomes second, 1 being white
        uniform, ///< drawn between first and second
        normal, ///< drawn: mean first, standard deviation second
        matched, ///< the median gets the level that as many captures lie below
        drawn_match, ///< drawn by quantiles
    } kind
        = Kind::stops;
    double first = 0.0, second = 0.0;
    Quantiles quantiles {}; ///< of what is drawn, or of captures' levels
    Quantiles renders {}; ///< of renders' levels
    std::string sensor {}; ///< whose captures they are of
    std::string text {}; ///< as it was given
};

/// What one exposure is asked to be.
struct Run {
    std::string illuminant; ///< grammar of illuminant.h; a monochrome sensor needs none
    std::optional<double> iso; ///< none: no noise
    std::optional<NoiseModel> noise_model; ///< none: as the profile's noise_effects say
    std::uint64_t seed = 0; ///< of everything random
    std::int64_t frame = 0; ///< temporal noise differs between frames
    double digital_gain = 1.0;
    bool sample_digital_gain = false; ///< draw it from the profile instead
    Convention convention = Convention::dng;
    bool keep_highlights = true;
    bool effects = true; ///< false: neither the profile's effects nor noise
    bool camera_input = false; ///< pixels already are camera RGB under this illuminant
    bool color_effects
        = true; ///< false: those of stage color already are in the pixels
    std::optional<Vec3> as_shot; ///< neutral that the word as-shot stands for
    std::optional<ExposureRule> exposure; ///< none: the scene as it is
    std::optional<double> exposure_time; ///< s; some effects need it
    std::optional<double> f_number;
    /// Of the value 1, cd/m2: the signal follows time, aperture and ISO then.
    std::optional<double> scene_luminance;
    double nd_filter
        = 0.0; ///< stops that a neutral density filter takes of scene_luminance
    /// Of what the meter finds; none: 1/8000 to 30 s, 1 to 32, the calibrated ISOs.
    std::optional<Limits> time_limits, f_number_limits, iso_limits;
    std::optional<double> bracket; ///< stops by which exposure_time is another
    std::optional<double> meter; ///< what it read, if the exposure needs one
};

/// The seed of temporal noise: the frames of a bracket are taken one after the other,
/// and their noise differs.
std::uint64_t noise_seed(const Run& run);

} // namespace cg2raw

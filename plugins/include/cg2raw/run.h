// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What one exposure is asked to be.
#pragma once

#include "cg2raw/transform.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace cg2raw {

/// How the noise of an ISO is drawn; its variance is the same in both.
enum class NoiseModel {
    gaussian, ///< shot_noise and read_noise
    physical, ///< poisson_shot_noise, heavy_tailed_noise and row_noise: needs an ISO
};
/// "gaussian" or "physical". Throws Error on other words.
NoiseModel noise_model_from_name(std::string_view name);
const char* name_of(NoiseModel model);

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
    std::optional<double> exposure_time; ///< s; some effects need it
};

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The effects of one run in the order of their stages, on a band of rows.
#pragma once

#include "active_effects.h"

namespace cg2raw {

/// Rows that pass through all stages together; few, so that they stay in the cache.
constexpr int band_rows = 2;

/// Room for one band on its way; one per thread.
struct Band {
    std::vector<float> pixels;
    std::array<Plane<float>, 3> camera;
    Plane<float> mosaic, variance, noise;

    explicit Band(int width);
    /// At most as wide as at first, and band_rows high.
    void resize(int width, int rows);
};

/// Whether effects draw what they can, or only state mean and variance.
enum class Purpose { drawing, prediction };

struct Stages {
    CfaPattern cfa;
    std::vector<ActiveEffect> active;
    bool gaussian; ///< some active effect has a variance to draw from
    Rng rng; ///< of the Gaussian that the effects' variances add up to
    /// A sensor clips after its noise, and what was clipped lay far above white: it
    /// reads white, or raw converters see coloured speckles in highlights. The paper's
    /// noise falls on clipped white too.
    float noise_ceiling;

    Stages(const SensorProfile& profile, const Run& run,
           std::vector<ActiveEffect> effects);

    /// Effects of the optics, in place, on planes whose first pixel is @p origin.
    void on_camera(const std::array<Plane<float>, 3>& camera, Site origin,
                   const Exposure& exposure, Purpose purpose) const;
    /// All later stages: mosaic in place, hence its variance; noise is scratch.
    void on_mosaic(const Plane<float>& mosaic, const Plane<float>& variance,
                   const Plane<float>& noise, Site origin, const Exposure& exposure,
                   Purpose purpose) const;
};

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The effects of one run in the order of their stages, on a band of rows.
#pragma once

#include "run_effects.h"

namespace cg2raw {

/// Rows that pass through all stages together; few, so that they stay in the cache.
constexpr int band_rows = 2;

/// Room for one band, or one block, on its way; one per thread.
struct Band {
    std::vector<float> pixels;
    std::array<Plane<float>, 3> camera;
    Plane<float> mosaic, variance, noise;

    /// What the planes held is lost.
    void resize(int width, int rows);
    /// The mosaic of the camera RGB, whose first pixel is @p origin.
    void to_mosaic(const CfaPattern& cfa, Site origin) const;
};

/// Whether effects draw what they can, or only state mean and variance.
enum class Purpose { drawing, prediction };

struct Stages {
    CfaPattern cfa;
    std::vector<ActiveEffect> active;
    bool saturates; ///< some active effect is of stage saturation
    /// Some effect has a variance to draw from: of light and charge, where what follows
    /// saturates; else of all noise; and of what is left after the saturation.
    bool early_gaussian, gaussian;
    Rng early_rng, rng; ///< of the Gaussians that these variances add up to
    /// A sensor clips after its noise, and what was clipped lay far above white: it
    /// reads white, or raw converters see coloured speckles in highlights. The paper's
    /// noise falls on clipped white too.
    float noise_ceiling;

    Stages(const SensorProfile& profile, const Run& run,
           std::vector<ActiveEffect> effects);

    /// An effect that reaches beyond its pixel or needs the glare_context; null if none
    /// does.
    const Effect* beyond_pixels() const;
    bool needs_glare_context() const;

    /// The glare_context of what enters the lens becomes that of what enters the
    /// optics: the effects of stage color are linear and the same everywhere.
    void pass_color(GlareContext& glare_context, const Exposure& exposure) const;
    /// Effects before the mosaic, in place, on planes whose first pixel is @p origin.
    void on_camera(const std::array<Plane<float>, 3>& camera, Site origin,
                   const Exposure& exposure, Purpose purpose) const;
    /// All later stages: mosaic in place, hence its variance; noise is scratch. @p
    /// exposed, where given, becomes the mosaic as it is before its noise.
    void on_mosaic(const Plane<float>& mosaic, const Plane<float>& variance,
                   const Plane<float>& noise, Site origin, const Exposure& exposure,
                   Purpose purpose, const Plane<float>* exposed = nullptr) const;

private:
    void settle(Signal& signal, Purpose purpose, bool gaussian, const Rng& rng) const;
};

} // namespace cg2raw

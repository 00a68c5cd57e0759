// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What a Simulation has decided before the first pixel.
#pragma once

#include "cg2raw/simulation.h"

#include "cg2raw/exposure.h"
#include "digitise.h"
#include "run_stages.h"

namespace cg2raw {

struct Simulation::State {
    SensorProfile profile;
    SettledExposure exposure;
    Run run; ///< with the settings that were found
    Size frame;
    Illuminant light;
    double gain;
    CameraTransform transform;
    std::optional<NoiseAtIso> noise;
    Stages stages;
    Levels levels;

    /// Throws Error.
    State(const SensorProfile& sensor, const Run& asked, Size size);

    /// Scene pixels -> camera RGB, planes of the same size.
    void to_camera_rgb(const RgbView& scene, const std::array<Plane<float>, 3>& camera,
                       Illegal& illegal) const;
    /// All stages in order on the camera RGB of a band; the signal is its mosaic then.
    void run_stages(Band& band, Site origin, const GlareContext* glare_context,
                    Purpose purpose) const;
    /// Calls done(row of the block, its signal, its variance) for every row.
    template <class Done>
    void each_row(const RgbView& scene, Site origin, Purpose purpose, Illegal& illegal,
                  const Done& done) const;
};

} // namespace cg2raw

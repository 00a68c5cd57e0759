// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file A simulation: everything decided before the first pixel, then pixels -> DN.
#pragma once

#include "cg2raw/effect.h"
#include "cg2raw/run.h"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cg2raw {

struct SettledExposure;

/// Everything decided before the first pixel; then blocks of pixels in any order, on
/// any thread, with the same result.
///
/// Where an effect needs more of the frame than its pixel, a block cannot be simulated
/// by itself: see CameraFrame. simulate() does either.
class Simulation {
public:
    /// Throws Error, also if an effect needs an exposure time that the run has not.
    Simulation(const SensorProfile& profile, const Run& run, Size frame);

    /// Some active effect reaches beyond its pixel or needs the glare context; the
    /// three below throw Error then.
    bool needs_whole_frame() const;
    /// Pixels around a site that its result depends on, by all active effects.
    int reach() const;

    /// Scene pixels of a block whose first pixel is @p origin -> DN.
    void block(const RgbView& scene, Site origin, const Plane<std::uint16_t>& raw,
               Illegal& illegal) const;
    /// The same before quantisation: signal in 0..1 above black, not clamped. For
    /// tests.
    void block(const RgbView& scene, Site origin, const Plane<float>& signal,
               Illegal& illegal) const;

    /// What is predicted of the same block: the mean of the signal before quantisation,
    /// and the variance over frames of each pixel, in the square of 0..1 above black;
    /// none where the signal is clipped before its noise. The rounding to DN adds
    /// 1/12 DN^2.
    void predict(const RgbView& scene, Site origin, const Plane<float>& mean,
                 const Plane<float>& variance, Illegal& illegal) const;

    const SensorProfile& profile() const;
    /// Its time, aperture and ISO are those that were given or found.
    const Run& run() const;
    Size frame() const;
    const Illuminant& illuminant() const;
    /// What convention spectral takes for the light's spectrum, in words; empty if
    /// another convention does not.
    std::string spectrum() const;
    const SettledExposure& exposure() const;
    /// After sampling, if that was asked.
    double digital_gain() const;
    /// Noise of the run's ISO; nothing when the run is clean.
    const std::optional<NoiseAtIso>& noise() const;
    /// Values of an effect that is active in this run; nothing if it is not.
    std::optional<Values> active(std::string_view effect_name) const;
    /// Names of all effects that are, in the order of application.
    std::vector<std::string> effects() const;

    ~Simulation();
    Simulation(Simulation&&) noexcept;

private:
    friend class CameraFrame;
    struct State;
    std::unique_ptr<const State> m_state;
};

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Single stages on a signal that is already there: noise, one effect, DN.
#pragma once

#include "cg2raw/parallel.h"
#include "cg2raw/run.h"

#include <cstdint>
#include <vector>

namespace cg2raw {

/// Adds the noise of the run's ISO, and nothing else, to a clean mosaic in place, drawn
/// as in a simulation of the same run. @p signal is the whole active area, 0..1 above
/// black. Throws Error without an ISO, and for pixels that are not finite.
void add_noise(const SensorProfile& profile, const Run& run, const Plane<float>& signal,
               const ParallelFor& parallel);

/// One effect, and nothing else, in place on the whole active area: @p planes are the
/// three of camera RGB for an effect of stage color or optics, else the one mosaic,
/// 0..1 above black. What is random has the key of the run and the profile. Throws
/// Error.
void apply_effect(const SensorProfile& profile, const EffectSetting& setting,
                  const Run& run, const std::vector<Plane<float>>& planes,
                  const ParallelFor& parallel);
/// What it is predicted to do: the planes become the mean; @p variance, over frames and
/// of the mosaic, is 0 for an effect before it.
void predict_effect(const SensorProfile& profile, const EffectSetting& setting,
                    const Run& run, const std::vector<Plane<float>>& planes,
                    const Plane<float>& variance, const ParallelFor& parallel);

/// DN = round(signal (white - black) + black), clamped to 0 ... white, per CFA site.
void raw_from_signal(const SensorProfile& profile, const Plane<const float>& signal,
                     const Plane<std::uint16_t>& raw);
/// (DN - black) / (white - black), per CFA site; below black it is negative.
void signal_from_raw(const SensorProfile& profile,
                     const Plane<const std::uint16_t>& raw, const Plane<float>& signal);

} // namespace cg2raw

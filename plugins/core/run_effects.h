// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The effects of one run: those that the profile lists, and those that make the
/// noise of its ISO.
#pragma once

#include "cg2raw/effect.h"
#include "cg2raw/run.h"

namespace cg2raw {

/// An effect, its values, its random numbers, and how it draws by these: null where it
/// states a variance that is drawn with others'.
struct ActiveEffect {
    const Effect* effect;
    Values values;
    Rng rng;
    void (*draw)(Signal&, const Values&, const Rng&);
};

/// In the order of application. Throws Error for unknown effects, bad parameters and
/// effects that would act twice, and if the noise model needs what @p noise lacks.
std::vector<ActiveEffect> active_effects(const SensorProfile& profile, const Run& run,
                                         const std::optional<NoiseAtIso>& noise);

/// The complete list of a prediction, whatever the profile lists: names and values in
/// the order of Effect::parameters. Throws Error as above.
std::vector<ActiveEffect> active_effects(const SensorProfile& profile,
                                         const std::vector<NamedValues>& settings);

/// Throws Error if some effect needs what @p exposure lacks.
void check_needs(const std::vector<ActiveEffect>& active, const Exposure& exposure);

/// Pixels around a site that the effects between two stages, together, depend on.
int reach_of(const std::vector<ActiveEffect>& active, Stage first, Stage last);

/// Noise of the run's ISO; none when the run is clean. Throws Error.
std::optional<NoiseAtIso> noise_of(const SensorProfile& profile, const Run& run);

} // namespace cg2raw

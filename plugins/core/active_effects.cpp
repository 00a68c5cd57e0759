// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "active_effects.h"

#include "text.h"

#include <algorithm>
#include <tuple>

namespace cg2raw {
namespace {

/// A fixed pattern belongs to the sensor, whatever the run's seed.
Rng rng_of(const Effect& effect, const SensorProfile& profile, const Run& run)
{
    const std::string key = effect.name + "/" + profile.id;
    return effect.pattern == Pattern::temporal ? Rng(run.seed, key, run.frame)
                                               : Rng(0, key);
}

const Effect& effect_of(const std::string& name, const SensorProfile& profile)
{
    try {
        return effect(name);
    } catch (const Error& error) {
        throw Error("sensor " + profile.id + ": " + error.what());
    }
}

/// An effect by name, and its values.
using Setting = std::pair<const char*, Values>;

std::vector<Setting> physical_noise(const NoiseAtIso& noise)
{
    const auto& [lambda, row_sigma] = *noise.shape;
    Values of_pixels = noise.beta2;
    for (double& variance : of_pixels)
        variance = std::max(0.0, variance - row_sigma * row_sigma);
    of_pixels.push_back(lambda);
    return { { "photon_statistics", noise.beta1 },
             { "heavy_tailed_noise", of_pixels },
             { "row_noise", { row_sigma } } };
}

std::vector<Setting> noise_settings(const SensorProfile& profile, NoiseModel model,
                                    const NoiseAtIso& noise)
{
    if (model == NoiseModel::gaussian)
        return { { "shot_noise", noise.beta1 }, { "read_noise", noise.beta2 } };
    if (!noise.shape)
        throw Error("sensor " + profile.id
                    + ": noise physical needs tukey_lambda and row_sigma in each row "
                      "of the profile's noise, and they are missing: add them, or say "
                      "gaussian");
    return physical_noise(noise);
}

bool holds(const std::vector<ActiveEffect>& active, const Effect& effect)
{
    return std::any_of(active.begin(), active.end(),
                       [&](const ActiveEffect& one) { return one.effect == &effect; });
}

void sort_by_stage(std::vector<ActiveEffect>& active)
{
    std::sort(active.begin(), active.end(),
              [](const ActiveEffect& a, const ActiveEffect& b) {
                  return std::tie(a.effect->stage, a.effect->name)
                      < std::tie(b.effect->stage, b.effect->name);
              });
}

} // namespace

NoiseModel noise_model_from_name(std::string_view name)
{
    if (name == "gaussian")
        return NoiseModel::gaussian;
    if (name == "physical")
        return NoiseModel::physical;
    throw Error("noise \"" + std::string(name) + "\" must be gaussian or physical");
}

std::vector<ActiveEffect> active_effects(const SensorProfile& profile, const Run& run,
                                         const std::optional<NoiseAtIso>& noise)
{
    std::vector<ActiveEffect> active;
    if (!run.effects)
        return active;
    const auto add = [&](const Effect& effect, Values values) {
        if (holds(active, effect))
            throw Error("sensor " + profile.id + ": effect " + effect.name
                        + " would act twice: leave it out of the profile's effects, or "
                          "the ISO out of the run");
        active.push_back({ &effect, std::move(values), rng_of(effect, profile, run) });
    };
    for (const EffectSetting& setting : profile.effects) {
        const Effect& known = effect_of(setting.name, profile);
        check_sites(known, profile.cfa, "sensor " + profile.id);
        add(known, values_of(known, setting.parameters, "sensor " + profile.id));
    }
    if (noise)
        for (auto& [name, values] : noise_settings(profile, run.noise_model, *noise))
            add(effect(name), std::move(values));
    sort_by_stage(active);
    return active;
}

std::vector<ActiveEffect> active_effects(const SensorProfile& profile,
                                         const std::vector<NamedValues>& settings)
{
    const std::string where = "prediction of sensor " + profile.id;
    std::vector<ActiveEffect> active;
    for (const auto& [name, values] : settings) {
        const Effect& known = effect_of(name, profile);
        if (holds(active, known))
            throw Error(where + ": effect " + name + " is given twice: give it once");
        check_sites(known, profile.cfa, where);
        check_values(known, values, where);
        active.push_back({ &known, values, rng_of(known, profile, {}) });
    }
    sort_by_stage(active);
    return active;
}

void check_needs(const std::vector<ActiveEffect>& active, const Exposure& exposure)
{
    for (const ActiveEffect& one : active) {
        const std::string where = "effect " + one.effect->name + " needs ";
        if (one.effect->needs_exposure_time && !exposure.seconds)
            throw Error(
                where
                + "an exposure time: give exposure_time in seconds (ExposureTime "
                  "of an image, Exif)");
        if (one.effect->needs_surround && !exposure.surround)
            throw Error(where
                        + "the surround of a block: give that of the whole frame's "
                          "camera RGB");
    }
}

int reach_of(const std::vector<ActiveEffect>& active, Stage first, Stage last)
{
    int reach = 0;
    for (const ActiveEffect& one : active)
        if (one.effect->stage >= first && one.effect->stage <= last)
            reach += one.effect->reach;
    return reach;
}

std::optional<NoiseAtIso> noise_of(const SensorProfile& profile, const Run& run)
{
    if (run.noise_model == NoiseModel::physical && !run.iso)
        throw Error("noise physical needs an iso: give one, or leave noise out");
    if (!run.effects || !run.iso)
        return std::nullopt;
    return noise_at(profile, *run.iso);
}

} // namespace cg2raw

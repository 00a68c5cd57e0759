// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "run_effects.h"

#include "effect_values.h"
#include "text.h"
#include "tukey_lambda.h"

#include <algorithm>
#include <tuple>

namespace cg2raw {
namespace {

/// As far as Exif goes.
constexpr double most_seconds = 1e6;

/// A fixed pattern belongs to the sensor, whatever the run's seed.
Rng rng_of(const Effect& effect, const SensorProfile& profile, const Run& run)
{
    const std::string key = effect.name + "/" + profile.id;
    return effect.pattern == Pattern::temporal ? Rng(noise_seed(run), key, run.frame)
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
using Setting = std::pair<std::string, Values>;

NoiseEffects noise_effects_of(const SensorProfile& profile, const Run& run)
{
    if (!run.noise_model)
        return profile.noise_effects.value_or(NoiseEffects {});
    return run.noise_model == NoiseModel::gaussian
        ? NoiseEffects {}
        : NoiseEffects { "poisson_shot_noise", "heavy_tailed_noise" };
}

Values heavy_tailed_values(const NoiseAtIso& noise)
{
    const auto& [lambda, row_sigma, outliers] = *noise.shape;
    Values values = noise.beta2;
    for (double& variance : values)
        variance = std::max(0.0, variance - row_sigma * row_sigma);
    const Outliers none { 0.0, 1.0 }, some = outliers.value_or(none);
    values.insert(values.end(), { lambda, some.fraction, some.variance_ratio });
    return values;
}

std::vector<Setting> noise_settings(const SensorProfile& profile, const Run& run,
                                    const NoiseAtIso& noise)
{
    const auto [of_light, of_readout] = noise_effects_of(profile, run);
    std::vector<Setting> settings { { of_light, noise.beta1 } };
    if (of_readout == "read_noise") {
        settings.emplace_back(of_readout, noise.beta2);
        return settings;
    }
    if (!noise.shape)
        throw Error("sensor " + profile.id
                    + ": noise physical needs tukey_lambda and row_sigma in each row "
                      "of the profile's noise, and they are missing: add them, or say "
                      "gaussian");
    settings.emplace_back(of_readout, heavy_tailed_values(noise));
    if (noise.shape->row_sigma > 0.0)
        settings.emplace_back("row_noise", Values { noise.shape->row_sigma });
    return settings;
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

/// Read noise is drawn apart, from normals that correlate along rows, where some effect
/// says so; its variance stays. Throws Error for noise that is not made of normals.
void correlate_read_noise(std::vector<ActiveEffect>& active, const std::string& where)
{
    const auto found
        = std::find_if(active.begin(), active.end(), [](const ActiveEffect& one) {
              return one.effect->name == "read_noise_correlation";
          });
    const double coefficient = found == active.end() ? 0.0 : found->values[0];
    if (coefficient == 0.0)
        return;
    for (ActiveEffect& one : active) {
        const bool heavy = one.effect->name == "heavy_tailed_noise";
        if (heavy && !has_normal_core(one.values))
            throw Error(where + ": effect read_noise_correlation does not combine with"
                        + " noise physical of tukey_lambda "
                        + number(*(one.values.end() - 3)) + " without outliers: say "
                        + "noise gaussian, or give outlier_fraction above 0 and "
                        + "tukey_lambda 0.14, or leave the effect out");
        if (heavy || one.effect->draw_apart)
            one.rng = one.rng.correlated(coefficient);
        if (one.effect->draw_apart)
            one.draw = one.effect->draw_apart;
    }
}

void check_exposure_time(const std::vector<ActiveEffect>& active,
                         const std::optional<double>& seconds)
{
    if (seconds && !(*seconds >= 0.0 && *seconds <= most_seconds))
        throw Error("exposure_time " + number(*seconds) + " must be 0 to "
                    + number(most_seconds) + " s");
    for (const ActiveEffect& one : active)
        if (one.effect->needs_exposure_time && !seconds)
            throw Error("effect " + one.effect->name
                        + " needs an exposure time: give exposure_time in seconds, or "
                          "the image its Exif (oiiotool --attrib ExposureTime 0.01)");
}

/// A RAW space of OpenColorIO holds the profile's effects of stage color, and they
/// cannot be taken out of its pixels.
void check_color_effects(const SensorProfile& profile, const Run& run)
{
    if (run.color_effects || run.effects)
        return;
    for (const EffectSetting& setting : profile.effects)
        if (effect_of(setting.name, profile).stage == Stage::color)
            throw Error("sensor " + profile.id + ": without effects is asked for, and"
                        + " the pixels are in a RAW space, which has effect "
                        + setting.name + " in it: convert from the scene, or keep the"
                        + " effects");
}

} // namespace

std::vector<ActiveEffect> active_effects(const SensorProfile& profile, const Run& run,
                                         const std::optional<NoiseAtIso>& noise)
{
    std::vector<ActiveEffect> active;
    check_color_effects(profile, run);
    if (!run.effects)
        return active;
    const auto add = [&](const Effect& effect, Values values) {
        if (holds(active, effect))
            throw Error("sensor " + profile.id + ": effect " + effect.name
                        + " would act twice: leave it out of the profile's effects, or "
                          "the ISO out of the run");
        active.push_back(
            { &effect, std::move(values), rng_of(effect, profile, run), effect.draw });
    };
    for (const EffectSetting& setting : profile.effects) {
        const Effect& known = effect_of(setting.name, profile);
        if (known.stage == Stage::color && !run.color_effects)
            continue;
        add(known,
            values_of(known, setting.parameters, profile.cfa, "sensor " + profile.id));
    }
    if (noise)
        for (auto& [name, values] : noise_settings(profile, run, *noise))
            add(effect(name), std::move(values));
    sort_by_stage(active);
    correlate_read_noise(active, "sensor " + profile.id);
    check_exposure_time(active, run.exposure_time);
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
        active.push_back({ &known, completed(known, values, profile.cfa, where),
                           rng_of(known, profile, {}), known.draw });
    }
    sort_by_stage(active);
    return active;
}

void check_needs(const std::vector<ActiveEffect>& active, const Exposure& exposure)
{
    check_exposure_time(active, exposure.seconds);
    for (const ActiveEffect& one : active)
        if (one.effect->needs_glare_context && !exposure.glare_context)
            throw Error("effect " + one.effect->name
                        + " needs the glare context of a block: give that of the whole "
                          "frame's camera RGB");
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

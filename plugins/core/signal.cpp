// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/signal.h"

#include "digitise.h"
#include "run_stages.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace cg2raw {
namespace {

/// Whether all values are finite; without a way out of the loop, which is vectorised
/// so.
bool all_finite(const float* values, int count)
{
    int others = 0;
    for (int i = 0; i < count; ++i)
        others |= !(std::fabs(values[i]) <= std::numeric_limits<float>::max());
    return others == 0;
}

/// Throws Error for the first value that is not finite, if there is one.
void check_finite(const Plane<float>& plane, const ParallelFor& parallel)
{
    std::atomic<bool> finite { true };
    each_strip(plane.height, parallel, [&](int first, int count) {
        for (int row = first; row < first + count; ++row)
            if (!all_finite(plane.row(row), plane.width))
                finite = false;
    });
    for (int row = 0; !finite && row < plane.height; ++row) {
        const float* const first = plane.row(row);
        const float* const end = first + plane.width;
        const float* const bad
            = std::find_if(first, end, [](float x) { return !std::isfinite(x); });
        if (bad != end)
            throw Error("signal at row " + std::to_string(row) + ", col "
                        + std::to_string(bad - first)
                        + " is not finite: replace NaN and infinities first");
    }
}

/// All stages of the mosaic, in place; the variance is kept where @p variance is given.
void pass(const Stages& stages, Purpose purpose, const Exposure& exposure,
          const Plane<float>& signal, const Plane<float>* variance,
          const ParallelFor& parallel)
{
    const auto on_rows = [&](Band& band, int row, int rows) {
        band.resize(signal.width, rows);
        stages.on_mosaic(signal.rows(row, rows),
                         variance ? variance->rows(row, rows) : band.variance,
                         band.noise, { row, 0 }, exposure, purpose);
    };
    if (stages.beyond_pixels()) {
        Band band;
        on_rows(band, 0, signal.height);
        return;
    }
    each_strip(signal.height, parallel, [&](int first, int count) {
        Band band;
        for (int row = first; row < first + count; row += band_rows)
            on_rows(band, row, std::min(band_rows, first + count - row));
    });
}

/// The effects before the mosaic, in place.
void pass_camera(const Stages& stages, Purpose purpose, Exposure exposure,
                 const std::array<Plane<float>, 3>& camera)
{
    GlareContext glare_context;
    if (stages.needs_glare_context()) {
        std::array<Plane<const float>, 3> seen;
        for (std::size_t i = 0; i < 3; ++i)
            seen[i] = { camera[i].data, camera[i].width, camera[i].height,
                        camera[i].pitch };
        glare_context = glare_context_of(seen);
        exposure.glare_context = &glare_context;
    }
    stages.on_camera(camera, { 0, 0 }, exposure, purpose);
}

Stages stages_of(const SensorProfile& profile, const EffectSetting& setting, Run run)
{
    SensorProfile only = profile;
    only.effects = { setting };
    run.iso.reset();
    run.effects = true;
    return { only, run, active_effects(only, run, std::nullopt) };
}

void work_on(const SensorProfile& profile, const EffectSetting& setting, const Run& run,
             Purpose purpose, const std::vector<Plane<float>>& planes,
             const Plane<float>* variance, const ParallelFor& parallel)
{
    const Stages stages = stages_of(profile, setting, run);
    const Effect& effect = *stages.active.front().effect;
    const std::size_t wanted = effect.stage <= Stage::optics ? 3 : 1;
    if (planes.size() != wanted)
        throw Error(
            "effect " + effect.name + " is of stage " + name_of(effect.stage)
            + " and works on "
            + (wanted == 3 ? "camera RGB, three planes" : "the mosaic, one plane"));
    for (const Plane<float>& plane : planes)
        check_finite(plane, parallel);
    const Illuminant light = illuminant(profile, run.illuminant, run.as_shot);
    const Exposure exposure { { planes[0].width, planes[0].height },
                              stages.cfa,
                              light.neutral,
                              run.exposure_time,
                              nullptr };
    if (wanted == 1)
        pass(stages, purpose, exposure, planes[0], variance, parallel);
    else
        pass_camera(stages, purpose, exposure, { planes[0], planes[1], planes[2] });
}

} // namespace

void add_noise(const SensorProfile& profile, const Run& run, const Plane<float>& signal,
               const ParallelFor& parallel)
{
    if (!run.iso)
        throw Error("noise needs an iso: give one of sensor " + profile.id);
    SensorProfile noisy = profile;
    noisy.effects.clear();
    Run with_effects = run;
    with_effects.effects = true;
    const Stages stages { noisy, with_effects,
                          active_effects(noisy, with_effects,
                                         noise_of(noisy, with_effects)) };
    check_finite(signal, parallel);
    const Exposure exposure {
        { signal.width, signal.height }, stages.cfa, { 1, 1, 1 }, {}, nullptr
    };
    pass(stages, Purpose::drawing, exposure, signal, nullptr, parallel);
}

void apply_effect(const SensorProfile& profile, const EffectSetting& setting,
                  const Run& run, const std::vector<Plane<float>>& planes,
                  const ParallelFor& parallel)
{
    work_on(profile, setting, run, Purpose::drawing, planes, nullptr, parallel);
}

void predict_effect(const SensorProfile& profile, const EffectSetting& setting,
                    const Run& run, const std::vector<Plane<float>>& planes,
                    const Plane<float>& variance, const ParallelFor& parallel)
{
    for (int row = 0; row < variance.height; ++row)
        std::fill_n(variance.row(row), variance.width, 0.0f);
    work_on(profile, setting, run, Purpose::prediction, planes, &variance, parallel);
}

void raw_from_signal(const SensorProfile& profile, const Plane<const float>& signal,
                     const Plane<std::uint16_t>& raw)
{
    const Levels levels = levels_of(profile);
    for (int row = 0; row < signal.height; ++row)
        digitise(signal.row(row), levels, { row, 0 }, signal.width, raw.row(row));
}

void signal_from_raw(const SensorProfile& profile,
                     const Plane<const std::uint16_t>& raw, const Plane<float>& signal)
{
    const Levels levels = levels_of(profile);
    for (int row = 0; row < raw.height; ++row)
        undo_digitise(raw.row(row), levels, { row, 0 }, raw.width, signal.row(row));
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "run_stages.h"

#include "digitise.h"

#include <algorithm>
#include <limits>

namespace cg2raw {
namespace {

/// Above any signal.
constexpr float largest_signal = std::numeric_limits<float>::max();

void apply(const std::vector<ActiveEffect>& active, Purpose purpose, Stage first,
           Stage last, Signal& signal)
{
    for (const auto& [effect, values, rng, draw] : active) {
        if (effect->stage < first || effect->stage > last)
            continue;
        if (draw && (purpose == Purpose::drawing || effect->pattern == Pattern::fixed))
            draw(signal, values, rng);
        else
            effect->predict(signal, values);
    }
}

/// Some effect of these stages has a variance whose Gaussian is to be drawn.
bool needs_gaussian(const std::vector<ActiveEffect>& active, Stage first, Stage last)
{
    return std::any_of(active.begin(), active.end(), [&](const ActiveEffect& a) {
        return a.effect->stage >= first && a.effect->stage <= last && !a.draw;
    });
}

bool has_stage(const std::vector<ActiveEffect>& active, Stage stage)
{
    return std::any_of(active.begin(), active.end(),
                       [&](const ActiveEffect& a) { return a.effect->stage == stage; });
}

/// A clipped site has no variance.
void clear_clipped(const Plane<float>& mean, float ceiling,
                   const Plane<float>& variance)
{
    for (int row = 0; row < mean.height; ++row)
        for (int col = 0; col < mean.width; ++col)
            if (!(mean.row(row)[col] < ceiling))
                variance.row(row)[col] = 0.0f;
}

void clear(const Plane<float>& plane)
{
    for (int row = 0; row < plane.height; ++row)
        std::fill_n(plane.row(row), plane.width, 0.0f);
}

void copy(const Plane<float>& from, const Plane<float>& to)
{
    for (int row = 0; row < from.height; ++row)
        std::copy_n(from.row(row), from.width, to.row(row));
}

} // namespace

void Band::resize(int width, int rows)
{
    const std::size_t area = std::size_t(width) * std::size_t(rows);
    if (pixels.size() < 6 * area)
        pixels.resize(6 * area);
    float* next = pixels.data();
    for (Plane<float>* plane :
         { &camera[0], &camera[1], &camera[2], &mosaic, &variance, &noise }) {
        *plane = { next, width, rows, width };
        next += area;
    }
}

void Band::to_mosaic(const CfaPattern& cfa, Site origin) const
{
    for (int row = 0; row < mosaic.height; ++row) {
        const float* const rgb[3]
            = { camera[0].row(row), camera[1].row(row), camera[2].row(row) };
        cg2raw::mosaic(rgb, cfa, { origin.row + row, origin.col }, mosaic.width,
                       mosaic.row(row));
    }
}

Stages::Stages(const SensorProfile& profile, const Run& run,
               std::vector<ActiveEffect> effects)
    : cfa(profile.cfa)
    , active(std::move(effects))
    , saturates(has_stage(active, Stage::saturation))
    , early_gaussian(needs_gaussian(active, Stage::noise, Stage::noise))
    , gaussian(needs_gaussian(active, saturates ? Stage::readout : Stage::noise,
                              Stage::readout))
    , early_rng(noise_seed(run), "early_noise/" + profile.id, run.frame)
    , rng(noise_seed(run), "noise/" + profile.id, run.frame)
    , noise_ceiling(run.convention == Convention::dng ? saturated : largest_signal)
{
}

const Effect* Stages::beyond_pixels() const
{
    for (const ActiveEffect& one : active)
        if (one.effect->reach > 0 || one.effect->needs_glare_context)
            return one.effect;
    return nullptr;
}

bool Stages::needs_glare_context() const
{
    return std::any_of(active.begin(), active.end(), [](const ActiveEffect& a) {
        return a.effect->needs_glare_context;
    });
}

void Stages::pass_color(GlareContext& glare_context, const Exposure& exposure) const
{
    const auto [width, height] = glare_context.cells;
    std::array<Plane<float>, 3> wide, mean;
    std::array<float, 3> means;
    for (std::size_t i = 0; i < 3; ++i) {
        means[i] = float(glare_context.mean[i]);
        wide[i] = { glare_context.wide[i].data(), width, height, width };
        mean[i] = { &means[i], 1, 1, 1 };
    }
    if (!has_stage(active, Stage::color))
        return;
    for (const auto& planes : { wide, mean }) {
        Signal signal { 3, planes, {}, {}, { 0, 0 }, exposure };
        apply(active, Purpose::prediction, Stage::color, Stage::color, signal);
    }
    glare_context.mean = { means[0], means[1], means[2] };
}

void Stages::on_camera(const std::array<Plane<float>, 3>& camera, Site origin,
                       const Exposure& exposure, Purpose purpose) const
{
    Signal signal { 3, camera, {}, {}, origin, exposure };
    apply(active, purpose, Stage::color, Stage::optics, signal);
}

/// What was noise so far becomes the signal: in a prediction, the fixed patterns.
void Stages::settle(Signal& signal, Purpose purpose, bool draw_gaussian,
                    const Rng& key) const
{
    if (purpose == Purpose::drawing && draw_gaussian)
        add_gaussian(key, signal.origin, signal.variance, signal.noise);
    add_noise(signal.noise, noise_ceiling, signal.mean[0]);
}

void Stages::on_mosaic(const Plane<float>& mosaic, const Plane<float>& variance,
                       const Plane<float>& noise, Site origin, const Exposure& exposure,
                       Purpose purpose, const Plane<float>* exposed) const
{
    clear(variance);
    if (!active.empty())
        clear(noise);
    Signal signal { 1, { mosaic }, variance, noise, origin, exposure };
    apply(active, purpose, Stage::pixel, Stage::response, signal);
    if (exposed)
        copy(mosaic, *exposed);
    if (active.empty())
        return;
    apply(active, purpose, Stage::noise, Stage::noise, signal);
    if (saturates) {
        settle(signal, purpose, early_gaussian, early_rng);
        clear(noise);
        if (purpose == Purpose::drawing)
            clear(variance);
        apply(active, purpose, Stage::saturation, Stage::saturation, signal);
    }
    apply(active, purpose, Stage::readout, Stage::readout, signal);
    if (purpose == Purpose::prediction)
        clear_clipped(mosaic, noise_ceiling, variance);
    settle(signal, purpose, gaussian, rng);
    apply(active, purpose, Stage::adc, Stage::processing, signal);
}

} // namespace cg2raw

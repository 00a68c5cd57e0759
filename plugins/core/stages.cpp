// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "stages.h"

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
    for (const auto& [effect, values, rng] : active) {
        if (effect->stage < first || effect->stage > last)
            continue;
        if (purpose == Purpose::drawing && effect->draw)
            effect->draw(signal, values, rng);
        else
            effect->expect(signal, values);
    }
}

/// Some effect has a variance whose Gaussian is to be drawn.
bool needs_gaussian(const std::vector<ActiveEffect>& active)
{
    return std::any_of(active.begin(), active.end(), [](const ActiveEffect& a) {
        return a.effect->stage >= Stage::noise && a.effect->stage <= Stage::readout
            && !a.effect->draw;
    });
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

} // namespace

Band::Band(int width)
    : pixels(std::size_t(6 * band_rows) * std::size_t(width))
{
    resize(width, band_rows);
}

void Band::resize(int width, int rows)
{
    float* next = pixels.data();
    for (Plane<float>* plane :
         { &camera[0], &camera[1], &camera[2], &mosaic, &variance, &noise }) {
        *plane = { next, width, rows, width };
        next += std::ptrdiff_t(band_rows) * width;
    }
}

Stages::Stages(const SensorProfile& profile, const Run& run,
               std::vector<ActiveEffect> effects)
    : cfa(profile.cfa)
    , active(std::move(effects))
    , gaussian(needs_gaussian(active))
    , rng(run.seed, "noise/" + profile.id, run.frame)
    , noise_ceiling(run.convention == Convention::dng ? saturated : largest_signal)
{
}

void Stages::on_camera(const std::array<Plane<float>, 3>& camera, Site origin,
                       const Exposure& exposure, Purpose purpose) const
{
    Signal signal { 3, camera, {}, {}, origin, exposure };
    apply(active, purpose, Stage::color, Stage::optics, signal);
}

void Stages::on_mosaic(const Plane<float>& mosaic, const Plane<float>& variance,
                       const Plane<float>& noise, Site origin, const Exposure& exposure,
                       Purpose purpose) const
{
    clear(variance);
    if (active.empty())
        return;
    clear(noise);
    Signal signal { 1, { mosaic }, variance, noise, origin, exposure };
    apply(active, purpose, Stage::pixel, Stage::readout, signal);
    if (purpose == Purpose::prediction) {
        clear_clipped(mosaic, noise_ceiling, variance);
    } else {
        if (gaussian)
            add_gaussian(rng, origin, variance, noise);
        add_noise(noise, noise_ceiling, mosaic);
    }
    apply(active, purpose, Stage::conversion, Stage::output, signal);
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/simulation.h"

#include "simulation_state.h"
#include "text.h"

#include <algorithm>

namespace cg2raw {
namespace {

double drawn_gain(const SensorProfile& profile, const Run& run)
{
    if (!run.sample_digital_gain)
        return run.digital_gain;
    if (!profile.digital_gain)
        throw Error("sensor " + profile.id
                    + " has no digital_gain to sample from; give a number");
    const Rng rng(run.seed, "digital_gain", run.frame);
    const auto& [mean, sigma] = *profile.digital_gain;
    std::uint32_t draw = 0;
    while (mean + sigma * rng.normal(draw) <= 0.0) // the mean is above 0: this ends
        ++draw;
    return mean + sigma * rng.normal(draw);
}

Run with_settings(Run run, const SettledExposure& exposure)
{
    run.exposure_time = exposure.exposure_time;
    run.f_number = exposure.f_number;
    run.iso = exposure.iso;
    return run;
}

} // namespace

Simulation::State::State(const SensorProfile& sensor, const Run& asked, Size size)
    : profile(calibrated_for(sensor, asked.illuminant))
    , exposure(settle(profile, asked))
    , run(with_settings(asked, exposure))
    , frame(size)
    , light(cg2raw::illuminant(profile, run.illuminant, run.as_shot))
    , gain(drawn_gain(profile, run))
    , transform(
          camera_from_scene(profile, light, run.convention, gain, run.keep_highlights))
    , noise(noise_of(profile, run))
    , stages(profile, run, active_effects(profile, run, noise))
    , levels(levels_of(profile))
{
    transform.exposure = float(exposure.gain);
    if (frame.width < 1 || frame.height < 1)
        throw Error("image of " + std::to_string(frame.width) + " x "
                    + std::to_string(frame.height) + " pixels is empty");
    if (run.iso && !(*run.iso >= 1.0 && *run.iso <= 1e7))
        throw Error("iso " + number(*run.iso) + " must be 1 to 10000000");
}

void Simulation::State::to_camera_rgb(const RgbView& scene,
                                      const std::array<Plane<float>, 3>& planes,
                                      Illegal& illegal) const
{
    for (int row = 0; row < scene.height; ++row) {
        float* const camera[3]
            = { planes[0].row(row), planes[1].row(row), planes[2].row(row) };
        if (!run.camera_input) {
            to_camera(transform, scene.row(row), scene.pixel_stride, scene.width,
                      camera, illegal);
            continue;
        }
        copy_camera(scene.row(row), scene.pixel_stride, scene.width, transform.exposure,
                    camera, illegal);
        if (transform.is_light)
            for (float* plane : camera)
                std::transform(plane, plane + scene.width, plane,
                               [](float x) { return std::max(x, 0.0f); });
    }
}

void Simulation::State::run_stages(Band& band, Site origin,
                                   const GlareContext* glare_context,
                                   Purpose purpose) const
{
    const Exposure conditions
        = { frame, profile.cfa, light.neutral, run.exposure_time, glare_context };
    stages.on_camera(band.camera, origin, conditions, purpose);
    band.to_mosaic(profile.cfa, origin);
    stages.on_mosaic(band.mosaic, band.variance, band.noise, origin, conditions,
                     purpose);
}

template <class Done>
void Simulation::State::each_row(const RgbView& scene, Site origin, Purpose purpose,
                                 Illegal& illegal, const Done& done) const
{
    if (const Effect* effect = stages.beyond_pixels())
        throw Error("effect " + effect->name
                    + " needs the whole frame: simulate all of it, not by blocks");
    Band band;
    for (int start = 0; start < scene.height; start += band_rows) {
        const int rows = std::min(band_rows, scene.height - start);
        band.resize(scene.width, rows);
        const RgbView part { scene.row(start), scene.width, rows, scene.pixel_stride,
                             scene.row_stride };
        to_camera_rgb(part, band.camera, illegal);
        run_stages(band, { origin.row + start, origin.col }, nullptr, purpose);
        for (int row = 0; row < rows; ++row)
            done(start + row, band.mosaic.row(row), band.variance.row(row));
    }
}

Simulation::Simulation(const SensorProfile& profile, const Run& run, Size frame)
    : m_state(std::make_unique<const State>(profile, run, frame))
{
}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;

void Simulation::block(const RgbView& scene, Site origin,
                       const Plane<std::uint16_t>& raw, Illegal& illegal) const
{
    m_state->each_row(scene, origin, Purpose::drawing, illegal,
                      [&](int row, const float* signal, const float*) {
                          digitise(signal, m_state->levels,
                                   { origin.row + row, origin.col }, scene.width,
                                   raw.row(row));
                      });
}

void Simulation::block(const RgbView& scene, Site origin, const Plane<float>& signal,
                       Illegal& illegal) const
{
    m_state->each_row(scene, origin, Purpose::drawing, illegal,
                      [&](int row, const float* values, const float*) {
                          std::copy(values, values + scene.width, signal.row(row));
                      });
}

void Simulation::predict(const RgbView& scene, Site origin, const Plane<float>& mean,
                         const Plane<float>& variance, Illegal& illegal) const
{
    m_state->each_row(scene, origin, Purpose::prediction, illegal,
                      [&](int row, const float* means, const float* variances) {
                          std::copy(means, means + scene.width, mean.row(row));
                          std::copy(variances, variances + scene.width,
                                    variance.row(row));
                      });
}

bool Simulation::needs_whole_frame() const
{
    return m_state->stages.beyond_pixels() != nullptr;
}

int Simulation::reach() const
{
    return reach_of(m_state->stages.active, Stage::color, Stage::processing);
}

const SensorProfile& Simulation::profile() const { return m_state->profile; }
const Run& Simulation::run() const { return m_state->run; }
Size Simulation::frame() const { return m_state->frame; }
const Illuminant& Simulation::illuminant() const { return m_state->light; }
const SettledExposure& Simulation::exposure() const { return m_state->exposure; }
double Simulation::digital_gain() const { return m_state->gain; }
std::string Simulation::spectrum() const
{
    return m_state->run.camera_input ? "" : m_state->transform.spectrum;
}
const std::optional<NoiseAtIso>& Simulation::noise() const { return m_state->noise; }

std::optional<Values> Simulation::active(std::string_view effect_name) const
{
    for (const ActiveEffect& one : m_state->stages.active)
        if (one.effect->name == effect_name)
            return one.values;
    return std::nullopt;
}

std::vector<std::string> Simulation::effects() const
{
    std::vector<std::string> names;
    for (const ActiveEffect& one : m_state->stages.active)
        names.push_back(one.effect->name);
    return names;
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/pipeline.h"

#include "digitise.h"
#include "stages.h"
#include "text.h"

#include <algorithm>
#include <mutex>

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

} // namespace

struct Simulation::State {
    SensorProfile profile;
    Run run;
    Size frame;
    Illuminant light;
    double gain;
    CameraTransform transform;
    std::optional<NoiseAtIso> noise;
    Stages stages;
    Levels levels;

    State(const SensorProfile& sensor, const Run& asked, Size size)
        : profile(sensor)
        , run(asked)
        , frame(size)
        , light(cg2raw::illuminant(profile, run.illuminant, run.as_shot))
        , gain(drawn_gain(profile, run))
        , transform(camera_from_scene(profile, light, run.convention, gain,
                                      run.keep_highlights))
        , noise(noise_of(profile, run))
        , stages(profile, run, active_effects(profile, run, noise))
        , levels(levels_of(profile))
    {
        if (frame.width < 1 || frame.height < 1)
            throw Error("image of " + std::to_string(frame.width) + " x "
                        + std::to_string(frame.height) + " pixels is empty");
        if (run.iso && !(*run.iso >= 1.0 && *run.iso <= 1e7))
            throw Error("iso " + number(*run.iso) + " must be 1 to 10000000");
    }

    /// All stages in order, for one band; the signal ends in band.mosaic.
    void expose(const RgbView& scene, Site origin, Purpose purpose, Band& band,
                Illegal& illegal) const
    {
        to_camera_band(scene, band, illegal);
        const Exposure exposure { frame, profile.cfa, light.neutral };
        stages.on_camera(band.camera, origin, exposure, purpose);
        band.to_mosaic(profile.cfa, origin);
        stages.on_mosaic(band.mosaic, band.variance, band.noise, origin, exposure,
                         purpose);
    }

    void to_camera_band(const RgbView& scene, Band& band, Illegal& illegal) const
    {
        for (int row = 0; row < scene.height; ++row) {
            float* const camera[3] = { band.camera[0].row(row), band.camera[1].row(row),
                                       band.camera[2].row(row) };
            if (run.camera_input)
                copy_camera(scene.row(row), scene.pixel_stride, scene.width, camera,
                            illegal);
            else
                to_camera(transform, scene.row(row), scene.pixel_stride, scene.width,
                          camera, illegal);
        }
    }

    /// Calls done(row of the block, its signal, its variance) for every row.
    template <class Done>
    void each_row(const RgbView& scene, Site origin, Purpose purpose, Illegal& illegal,
                  const Done& done) const
    {
        Band band;
        for (int start = 0; start < scene.height; start += band_rows) {
            const int rows = std::min(band_rows, scene.height - start);
            band.resize(scene.width, rows);
            const RgbView part { scene.row(start), scene.width, rows,
                                 scene.pixel_stride, scene.row_stride };
            expose(part, { origin.row + start, origin.col }, purpose, band, illegal);
            for (int row = 0; row < rows; ++row)
                done(start + row, band.mosaic.row(row), band.variance.row(row));
        }
    }
};

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

void Simulation::expect(const RgbView& scene, Site origin, const Plane<float>& mean,
                        const Plane<float>& variance, Illegal& illegal) const
{
    m_state->each_row(scene, origin, Purpose::prediction, illegal,
                      [&](int row, const float* means, const float* variances) {
                          std::copy(means, means + scene.width, mean.row(row));
                          std::copy(variances, variances + scene.width,
                                    variance.row(row));
                      });
}

const SensorProfile& Simulation::profile() const { return m_state->profile; }
const Run& Simulation::run() const { return m_state->run; }
Size Simulation::frame() const { return m_state->frame; }
const Illuminant& Simulation::illuminant() const { return m_state->light; }
double Simulation::digital_gain() const { return m_state->gain; }
const std::optional<NoiseAtIso>& Simulation::noise() const { return m_state->noise; }

std::optional<Values> Simulation::active(std::string_view effect_name) const
{
    for (const ActiveEffect& one : m_state->stages.active)
        if (one.effect->name == effect_name)
            return one.values;
    return std::nullopt;
}

void each_strip(int height, const ParallelFor& parallel,
                const std::function<void(int first, int count)>& work)
{
    constexpr int strip_rows = 64;
    parallel((height + strip_rows - 1) / strip_rows, [&](int strip) {
        const int first = strip * strip_rows;
        work(first, std::min(strip_rows, height - first));
    });
}

Illegal each_strip(const SceneRows& rows, Size size, const ParallelFor& parallel,
                   const std::function<void(const RgbView&, int first, Illegal&)>& work)
{
    Illegal total;
    std::mutex guard;
    each_strip(size.height, parallel, [&](int first, int count) {
        std::vector<float> room;
        Illegal illegal;
        work(rows(first, count, room), first, illegal);
        const std::lock_guard lock(guard);
        total += illegal;
    });
    return total;
}

RawFrame simulate(const SceneRows& rows, const Simulation& simulation,
                  const ParallelFor& parallel)
{
    const auto [width, height] = simulation.frame();
    RawFrame frame { width, height, {}, {} };
    frame.dn.resize(std::size_t(width) * std::size_t(height));
    const Plane<std::uint16_t> raw { frame.dn.data(), width, height, width };
    frame.illegal = each_strip(
        rows, simulation.frame(), parallel,
        [&](const RgbView& part, int first, Illegal& illegal) {
            simulation.block(part, { first, 0 }, raw.rows(first, part.height), illegal);
        });
    return frame;
}

RawFrame simulate(const RgbView& scene, const Simulation& simulation,
                  const ParallelFor& parallel)
{
    const auto rows = [&](int first, int count, std::vector<float>&) {
        return RgbView { scene.row(first), scene.width, count, scene.pixel_stride,
                         scene.row_stride };
    };
    return simulate(rows, simulation, parallel);
}

} // namespace cg2raw

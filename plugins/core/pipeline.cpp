// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/pipeline.h"

#include "digitise.h"
#include "text.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace cg2raw {
namespace {

/// Rows that pass through all stages together; few, so that they stay in the cache.
constexpr int band_rows = 2;
/// Above any signal.
constexpr float largest_signal = std::numeric_limits<float>::max();

/// An effect, its values and its random numbers.
struct Active {
    const Effect* effect;
    Values values;
    Rng rng;
};

/// A fixed pattern belongs to the sensor, whatever the run's seed.
Rng rng_of(const Effect& effect, const SensorProfile& profile, const Run& run)
{
    const std::string key = effect.name + "/" + profile.id;
    return effect.pattern == Pattern::temporal ? Rng(run.seed, key, run.frame)
                                               : Rng(0, key);
}

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

const Effect& effect_of(const EffectSetting& setting, const SensorProfile& profile)
{
    try {
        return effect(setting.name);
    } catch (const Error& error) {
        throw Error("sensor " + profile.id + ": " + error.what());
    }
}

std::vector<Active> active_effects(const SensorProfile& profile, const Run& run,
                                   const std::optional<NoiseAtIso>& noise)
{
    std::vector<Active> active;
    if (!run.effects)
        return active;
    const auto add = [&](const Effect& effect, Values values) {
        for (const Active& other : active)
            if (other.effect == &effect)
                throw Error(
                    "sensor " + profile.id + ": effect " + effect.name
                    + " would act twice: leave it out of the profile's effects, or "
                      "the ISO out of the run");
        active.push_back({ &effect, std::move(values), rng_of(effect, profile, run) });
    };
    for (const EffectSetting& setting : profile.effects) {
        const Effect& known = effect_of(setting, profile);
        check_sites(known, profile.cfa, "sensor " + profile.id);
        add(known, values_of(known, setting.parameters, "sensor " + profile.id));
    }
    if (noise) {
        add(effect("shot_noise"), noise->beta1);
        add(effect("read_noise"), noise->beta2);
    }
    std::sort(active.begin(), active.end(), [](const Active& a, const Active& b) {
        return std::tie(a.effect->stage, a.effect->name)
            < std::tie(b.effect->stage, b.effect->name);
    });
    return active;
}

/// Room for one band on its way; one per thread.
struct Band {
    std::vector<float> pixels;
    std::array<Plane<float>, 3> camera;
    Plane<float> mosaic, variance;

    explicit Band(int width)
        : pixels(std::size_t(5 * band_rows) * std::size_t(width))
    {
        resize(width, band_rows);
    }

    void resize(int width, int rows)
    {
        float* next = pixels.data();
        for (Plane<float>* plane :
             { &camera[0], &camera[1], &camera[2], &mosaic, &variance }) {
            *plane = { next, width, rows, width };
            next += std::ptrdiff_t(band_rows) * width;
        }
    }
};

void apply(const std::vector<Active>& active, Stage first, Stage last, Signal& signal)
{
    for (const Active& one : active) {
        if (one.effect->stage < first || one.effect->stage > last)
            continue;
        one.effect->expect(signal, one.values);
        if (one.effect->draw)
            one.effect->draw(signal, one.values, one.rng);
    }
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
    std::vector<Active> active;
    bool noisy; ///< some active effect has a variance to draw from
    Rng rng; ///< of the Gaussian that the effects' variances add up to
    /// A sensor clips after its noise, and what was clipped lay far above white: it
    /// reads white, or raw converters see coloured speckles in highlights. The paper's
    /// noise falls on clipped white too.
    float noise_ceiling;
    Levels levels;

    State(const SensorProfile& sensor, const Run& asked, Size size)
        : profile(sensor)
        , run(asked)
        , frame(size)
        , light(cg2raw::illuminant(profile, run.illuminant, run.as_shot))
        , gain(drawn_gain(profile, run))
        , transform(camera_from_scene(profile, light, run.convention, gain,
                                      run.keep_highlights))
        , noise(run.effects && run.iso ? std::optional(noise_at(profile, *run.iso))
                                       : std::nullopt)
        , active(active_effects(profile, run, noise))
        , noisy(std::any_of(
              active.begin(), active.end(),
              [](const Active& a) { return a.effect->stage == Stage::noise; }))
        , rng(run.seed, "noise/" + profile.id, run.frame)
        , noise_ceiling(run.convention == Convention::dng ? saturated : largest_signal)
        , levels(levels_of(profile))
    {
        if (frame.width < 1 || frame.height < 1)
            throw Error("image of " + std::to_string(frame.width) + " x "
                        + std::to_string(frame.height) + " pixels is empty");
        if (run.iso && !(*run.iso >= 1.0 && *run.iso <= 1e7))
            throw Error("iso " + number(*run.iso) + " must be 1 to 10000000");
    }

    /// All stages in order, for one band; the signal ends in band.mosaic.
    void expose(const RgbView& scene, Site origin, Band& band, Illegal& illegal) const
    {
        to_camera_band(scene, band, illegal);
        Signal signal { 3, band.camera, {}, origin, frame, profile.cfa };
        apply(active, Stage::optics, Stage::optics, signal);
        for (int row = 0; row < scene.height; ++row) {
            const float* const camera[3]
                = { band.camera[0].row(row), band.camera[1].row(row),
                    band.camera[2].row(row) };
            mosaic(camera, profile.cfa, { origin.row + row, origin.col }, scene.width,
                   band.mosaic.row(row));
        }
        if (active.empty())
            return;
        signal.planes = 1;
        signal.mean = { band.mosaic };
        signal.variance = band.variance;
        std::fill_n(band.variance.data, scene.width * scene.height, 0.0f);
        apply(active, Stage::pixel, Stage::noise, signal);
        if (noisy)
            add_gaussian(rng, origin, band.variance, noise_ceiling, band.mosaic);
        apply(active, Stage::readout, Stage::output, signal);
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

    /// Calls done(row of the block, its signal) for every row.
    template <class Done>
    void each_row(const RgbView& scene, Site origin, Illegal& illegal,
                  const Done& done) const
    {
        Band band(scene.width);
        for (int start = 0; start < scene.height; start += band_rows) {
            const int rows = std::min(band_rows, scene.height - start);
            band.resize(scene.width, rows);
            const RgbView part { scene.row(start), scene.width, rows,
                                 scene.pixel_stride, scene.row_stride };
            expose(part, { origin.row + start, origin.col }, band, illegal);
            for (int row = 0; row < rows; ++row)
                done(start + row, band.mosaic.row(row));
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
    m_state->each_row(scene, origin, illegal, [&](int row, const float* signal) {
        digitise(signal, m_state->levels, { origin.row + row, origin.col }, scene.width,
                 raw.row(row));
    });
}

void Simulation::block(const RgbView& scene, Site origin, const Plane<float>& signal,
                       Illegal& illegal) const
{
    m_state->each_row(scene, origin, illegal, [&](int row, const float* values) {
        std::copy(values, values + scene.width, signal.row(row));
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
    for (const Active& one : m_state->active)
        if (one.effect->name == effect_name)
            return one.values;
    return std::nullopt;
}

RawFrame simulate(const RgbView& scene, const Simulation& simulation,
                  const ParallelFor& parallel)
{
    constexpr int task_rows = 64;
    RawFrame frame { scene.width, scene.height, {}, {} };
    frame.dn.resize(std::size_t(scene.width) * std::size_t(scene.height));
    const int tasks = (scene.height + task_rows - 1) / task_rows;
    std::vector<Illegal> illegal(std::size_t(tasks), Illegal {});
    parallel(tasks, [&](int task) {
        const int first = task * task_rows,
                  rows = std::min(task_rows, scene.height - first);
        const RgbView part { scene.row(first), scene.width, rows, scene.pixel_stride,
                             scene.row_stride };
        const Plane<std::uint16_t> raw { frame.dn.data()
                                             + std::ptrdiff_t(first) * scene.width,
                                         scene.width, rows, scene.width };
        simulation.block(part, { first, 0 }, raw, illegal[std::size_t(task)]);
    });
    for (const Illegal& part : illegal)
        frame.illegal += part;
    return frame;
}

} // namespace cg2raw

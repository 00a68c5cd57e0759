// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/pipeline.h"

#include "active_effects.h"
#include "digitise.h"
#include "text.h"

#include <algorithm>
#include <limits>

namespace cg2raw {
namespace {

/// Rows that pass through all stages together; few, so that they stay in the cache.
constexpr int band_rows = 2;
/// Above any signal.
constexpr float largest_signal = std::numeric_limits<float>::max();

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

/// Room for one band on its way; one per thread.
struct Band {
    std::vector<float> pixels;
    std::array<Plane<float>, 3> camera;
    Plane<float> mosaic, variance, noise;

    explicit Band(int width)
        : pixels(std::size_t(6 * band_rows) * std::size_t(width))
    {
        resize(width, band_rows);
    }

    void resize(int width, int rows)
    {
        float* next = pixels.data();
        for (Plane<float>* plane :
             { &camera[0], &camera[1], &camera[2], &mosaic, &variance, &noise }) {
            *plane = { next, width, rows, width };
            next += std::ptrdiff_t(band_rows) * width;
        }
    }
};

/// Whether effects draw what they can, or only state mean and variance.
enum class Purpose { drawing, prediction };

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
        return a.effect->stage == Stage::noise && !a.effect->draw;
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

} // namespace

struct Simulation::State {
    SensorProfile profile;
    Run run;
    Size frame;
    Illuminant light;
    double gain;
    CameraTransform transform;
    std::optional<NoiseAtIso> noise;
    std::vector<ActiveEffect> active;
    bool gaussian; ///< some active effect has a variance to draw from
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
        , noise(noise_of(profile, run))
        , active(active_effects(profile, run, noise))
        , gaussian(needs_gaussian(active))
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
    void expose(const RgbView& scene, Site origin, Purpose purpose, Band& band,
                Illegal& illegal) const
    {
        to_camera_band(scene, band, illegal);
        Signal signal { 3, band.camera, {}, {}, origin, frame, profile.cfa };
        apply(active, purpose, Stage::optics, Stage::optics, signal);
        for (int row = 0; row < scene.height; ++row) {
            const float* const camera[3]
                = { band.camera[0].row(row), band.camera[1].row(row),
                    band.camera[2].row(row) };
            mosaic(camera, profile.cfa, { origin.row + row, origin.col }, scene.width,
                   band.mosaic.row(row));
        }
        signal.planes = 1;
        signal.mean = { band.mosaic };
        signal.variance = band.variance;
        signal.noise = band.noise;
        std::fill_n(band.variance.data, scene.width * scene.height, 0.0f);
        if (active.empty())
            return;
        std::fill_n(band.noise.data, scene.width * scene.height, 0.0f);
        apply(active, purpose, Stage::pixel, Stage::readout, signal);
        if (purpose == Purpose::prediction) {
            clear_clipped(band.mosaic, noise_ceiling, band.variance);
        } else {
            if (gaussian)
                add_gaussian(rng, origin, band.variance, band.noise);
            add_noise(band.noise, noise_ceiling, band.mosaic);
        }
        apply(active, purpose, Stage::conversion, Stage::output, signal);
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
        Band band(scene.width);
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
    for (const ActiveEffect& one : m_state->active)
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

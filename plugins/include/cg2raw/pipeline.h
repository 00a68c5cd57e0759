// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file simulate(): stages 1 to 5 in order, then DN. The map of the core.
#pragma once

#include "cg2raw/effect.h"

#include <functional>
#include <memory>

namespace cg2raw {

/// How the noise of an ISO is drawn; its variance is the same in both.
enum class NoiseModel {
    gaussian, ///< shot_noise and read_noise
    physical, ///< photon_statistics, heavy_tailed_noise and row_noise: needs an ISO
};
/// "gaussian" or "physical". Throws Error on other words.
NoiseModel noise_model_from_name(std::string_view name);

/// What one exposure is asked to be.
struct Run {
    std::string illuminant; ///< grammar of illuminant.h
    std::optional<double> iso; ///< none: no noise
    std::optional<NoiseModel> noise_model; ///< none: as the profile's noise_effects say
    std::uint64_t seed = 0; ///< of everything random
    std::uint64_t frame = 0; ///< temporal noise differs between frames
    double digital_gain = 1.0;
    bool sample_digital_gain = false; ///< draw it from the profile instead
    Convention convention = Convention::dng;
    bool keep_highlights = true;
    bool effects = true; ///< false: neither the profile's effects nor noise
    bool camera_input = false; ///< pixels already are camera RGB under this illuminant
    bool color_effects
        = true; ///< false: those of stage color already are in the pixels
    std::optional<Vec3> as_shot; ///< neutral that the word as-shot stands for
    std::optional<double> exposure_time; ///< s; some effects need it
};

/// Calls task(0) ... task(count - 1), in any order, on any threads, and returns when
/// all are done.
using ParallelFor
    = std::function<void(int count, const std::function<void(int)>& task)>;
/// As many std::threads as asked; 0: one per core.
ParallelFor parallel_threads(int threads);

/// Everything decided before the first pixel; then blocks of pixels in any order, on
/// any thread, with the same result.
///
/// Where an effect needs more of the frame than its pixel, a block cannot be simulated
/// by itself: see CameraFrame. simulate() does either.
class Simulation {
public:
    /// Throws Error, also if an effect needs an exposure time that the run has not.
    Simulation(const SensorProfile& profile, const Run& run, Size frame);

    /// Some active effect reaches beyond its pixel or needs the surround; the three
    /// below throw Error then.
    bool needs_whole_frame() const;
    /// Pixels around a site that its result depends on, by all active effects.
    int reach() const;

    /// Scene pixels of a block whose first pixel is @p origin -> DN.
    void block(const RgbView& scene, Site origin, const Plane<std::uint16_t>& raw,
               Illegal& illegal) const;
    /// The same before quantisation: signal in 0..1 above black, not clamped. For
    /// tests.
    void block(const RgbView& scene, Site origin, const Plane<float>& signal,
               Illegal& illegal) const;

    /// What is predicted of the same block: the mean of the signal before quantisation,
    /// and the variance over frames of each pixel, in the square of 0..1 above black;
    /// none where the signal is clipped before its noise. The rounding to DN adds
    /// 1/12 DN^2.
    void expect(const RgbView& scene, Site origin, const Plane<float>& mean,
                const Plane<float>& variance, Illegal& illegal) const;

    const SensorProfile& profile() const;
    const Run& run() const;
    Size frame() const;
    const Illuminant& illuminant() const;
    /// After sampling, if that was asked.
    double digital_gain() const;
    /// Noise of the run's ISO; nothing when the run is clean.
    const std::optional<NoiseAtIso>& noise() const;
    /// Values of an effect that is active in this run; nothing if it is not.
    std::optional<Values> active(std::string_view effect_name) const;

    ~Simulation();
    Simulation(Simulation&&) noexcept;

private:
    friend class CameraFrame;
    struct State;
    std::unique_ptr<const State> m_state;
};

/// Camera RGB of a whole frame, held until all of it is there; then its rows are
/// simulated in blocks, each with as many pixels around it as the effects reach. It
/// gives what a Simulation gives by blocks, and the same bytes for any ParallelFor.
class CameraFrame {
public:
    /// @p simulation is to outlive it.
    explicit CameraFrame(const Simulation& simulation);

    /// Scene pixels of a block whose first pixel is @p origin; on any thread, in any
    /// order, each pixel once.
    void put(const RgbView& scene, Site origin, Illegal& illegal);
    /// After the last pixel, and before what follows.
    void complete();

    /// Rows of the frame from @p first on, as many as the result has: DN.
    void simulate(int first, const Plane<std::uint16_t>& raw,
                  const ParallelFor& parallel) const;
    /// The signal before quantisation.
    void simulate(int first, const Plane<float>& signal,
                  const ParallelFor& parallel) const;
    /// What is predicted of it, as by Simulation::expect().
    void expect(int first, const Plane<float>& mean, const Plane<float>& variance,
                const ParallelFor& parallel) const;

private:
    /// A piece of a row of the frame, simulated or predicted.
    struct Piece {
        Site at;
        int count;
        const float *signal, *variance;
    };
    enum class Result { simulation, prediction };
    void each_piece(int first, int rows, Result result, const ParallelFor& parallel,
                    const std::function<void(const Piece&)>& done) const;

    const Simulation& m_simulation;
    std::array<std::vector<float>, 3> m_camera;
    std::optional<Surround> m_surround; ///< as it enters the optics
};

/// Rows first ... first + count - 1 of a scene as float, wherever they lie: seen in
/// place, or converted in @p room.
using SceneRows
    = std::function<RgbView(int first, int count, std::vector<float>& room)>;
/// Calls work for strips of rows that together are all of them.
void each_strip(int height, const ParallelFor& parallel,
                const std::function<void(int first, int count)>& work);
/// The same for the pixels of a scene; the sum of what was not finite.
Illegal
each_strip(const SceneRows& rows, Size size, const ParallelFor& parallel,
           const std::function<void(const RgbView&, int first, Illegal&)>& work);

/// A mosaic of DN and its size.
struct RawFrame {
    int width, height;
    std::vector<std::uint16_t> dn;
    Illegal illegal;
};

/// The whole frame. Same bytes for any ParallelFor.
RawFrame simulate(const RgbView& scene, const Simulation& simulation,
                  const ParallelFor& parallel);
RawFrame simulate(const SceneRows& rows, const Simulation& simulation,
                  const ParallelFor& parallel);

/// The same before quantisation, and what is predicted of it, into whole planes.
Illegal simulate(const SceneRows& rows, const Simulation& simulation,
                 const Plane<float>& signal, const ParallelFor& parallel);
Illegal expect(const SceneRows& rows, const Simulation& simulation,
               const Plane<float>& mean, const Plane<float>& variance,
               const ParallelFor& parallel);

/// Adds the noise of the run's ISO, and nothing else, to a clean mosaic in place, drawn
/// as in a simulation of the same run. @p signal is the whole active area, 0..1 above
/// black. Throws Error without an ISO, and for pixels that are not finite.
void add_noise(const SensorProfile& profile, const Run& run, const Plane<float>& signal,
               const ParallelFor& parallel);

/// One effect, and nothing else, in place on the whole active area: @p planes are the
/// three of camera RGB for an effect of stage color or optics, else the one mosaic,
/// 0..1 above black. What is random has the key of the run and the profile. Throws
/// Error.
void apply_effect(const SensorProfile& profile, const EffectSetting& setting,
                  const Run& run, const std::vector<Plane<float>>& planes,
                  const ParallelFor& parallel);
/// What it is predicted to do: the planes become the mean; @p variance, over frames and
/// of the mosaic, is 0 for an effect before it.
void expect_effect(const SensorProfile& profile, const EffectSetting& setting,
                   const Run& run, const std::vector<Plane<float>>& planes,
                   const Plane<float>& variance, const ParallelFor& parallel);

/// DN = round(signal (white - black) + black), clamped to 0 ... white, per CFA site.
void raw_from_signal(const SensorProfile& profile, const Plane<const float>& signal,
                     const Plane<std::uint16_t>& raw);
/// (DN - black) / (white - black), per CFA site; below black it is negative.
void signal_from_raw(const SensorProfile& profile,
                     const Plane<const std::uint16_t>& raw, const Plane<float>& signal);

} // namespace cg2raw

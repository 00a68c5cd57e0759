// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file A frame that is held whole, for effects that need more of it than a pixel.
#pragma once

#include "cg2raw/parallel.h"
#include "cg2raw/simulation.h"

#include <array>
#include <functional>
#include <optional>
#include <vector>

namespace cg2raw {

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
    /// What is predicted of it, as by Simulation::predict().
    void predict(int first, const Plane<float>& mean, const Plane<float>& variance,
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
    std::optional<GlareContext> m_glare_context; ///< as it enters the optics
};

} // namespace cg2raw

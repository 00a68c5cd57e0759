// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file simulate(): a whole scene -> a whole RAW frame, whichever way its effects
/// need.
#pragma once

#include "cg2raw/parallel.h"
#include "cg2raw/simulation.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace cg2raw {

/// Rows first ... first + count - 1 of a scene as float, wherever they lie: seen in
/// place, or converted in @p room.
using SceneRows
    = std::function<RgbView(int first, int count, std::vector<float>& room)>;

/// Calls work for strips of rows of a scene that together are all of it; the sum of
/// what was not finite.
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
Illegal predict(const SceneRows& rows, const Simulation& simulation,
                const Plane<float>& mean, const Plane<float>& variance,
                const ParallelFor& parallel);

} // namespace cg2raw

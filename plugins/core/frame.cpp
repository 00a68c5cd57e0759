// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Whole frames: strip by strip where every pixel stands for itself, else held.
#include "cg2raw/frame.h"

#include "cg2raw/camera_frame.h"

#include <mutex>

namespace cg2raw {

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

namespace {

/// Calls by_strip(simulation, strip, first row, illegal) for every strip, or with_frame
/// once with the frame that is held.
template <class ByStrip, class WithFrame>
Illegal run_frame(const SceneRows& rows, const Simulation& simulation,
                  const ParallelFor& parallel, const ByStrip& by_strip,
                  const WithFrame& with_frame)
{
    const Size size = simulation.frame();
    if (!simulation.needs_whole_frame())
        return each_strip(rows, size, parallel, by_strip);
    CameraFrame frame(simulation);
    const Illegal illegal = each_strip(
        rows, size, parallel, [&](const RgbView& part, int first, Illegal& of_part) {
            frame.put(part, { first, 0 }, of_part);
        });
    frame.complete();
    with_frame(frame);
    return illegal;
}

} // namespace

RawFrame simulate(const SceneRows& rows, const Simulation& simulation,
                  const ParallelFor& parallel)
{
    const auto [width, height] = simulation.frame();
    RawFrame frame { width, height, {}, {} };
    frame.dn.resize(std::size_t(width) * std::size_t(height));
    const Plane<std::uint16_t> raw { frame.dn.data(), width, height, width };
    frame.illegal = run_frame(
        rows, simulation, parallel,
        [&](const RgbView& part, int first, Illegal& illegal) {
            simulation.block(part, { first, 0 }, raw.rows(first, part.height), illegal);
        },
        [&](const CameraFrame& held) { held.simulate(0, raw, parallel); });
    return frame;
}

Illegal simulate(const SceneRows& rows, const Simulation& simulation,
                 const Plane<float>& signal, const ParallelFor& parallel)
{
    return run_frame(
        rows, simulation, parallel,
        [&](const RgbView& part, int first, Illegal& illegal) {
            simulation.block(part, { first, 0 }, signal.rows(first, part.height),
                             illegal);
        },
        [&](const CameraFrame& held) { held.simulate(0, signal, parallel); });
}

Illegal predict(const SceneRows& rows, const Simulation& simulation,
                const Plane<float>& mean, const Plane<float>& variance,
                const ParallelFor& parallel)
{
    return run_frame(
        rows, simulation, parallel,
        [&](const RgbView& part, int first, Illegal& illegal) {
            simulation.predict(part, { first, 0 }, mean.rows(first, part.height),
                               variance.rows(first, part.height), illegal);
        },
        [&](const CameraFrame& held) { held.predict(0, mean, variance, parallel); });
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

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/camera_frame.h"

#include "simulation_state.h"

#include <algorithm>

namespace cg2raw {
namespace {

/// Pixels of a block across and down, without what it needs around it.
constexpr int block_side = 256;

/// Part of a frame, pixels.
struct Part {
    Site first;
    Size size;
};

/// The part with @p reach pixels around it, as far as they lie in the frame.
Part around(const Part& part, Size frame, int reach)
{
    const Site first { std::max(0, part.first.row - reach),
                       std::max(0, part.first.col - reach) };
    const int bottom
        = std::min(frame.height, part.first.row + part.size.height + reach);
    const int right = std::min(frame.width, part.first.col + part.size.width + reach);
    return { first, { right - first.col, bottom - first.row } };
}

void copy_part(const std::vector<float>& plane, int width, const Part& part,
               const Plane<float>& to)
{
    for (int row = 0; row < to.height; ++row)
        std::copy_n(plane.data() + std::ptrdiff_t(part.first.row + row) * width
                        + part.first.col,
                    to.width, to.row(row));
}

} // namespace

CameraFrame::CameraFrame(const Simulation& simulation)
    : m_simulation(simulation)
{
    const auto [width, height] = simulation.frame();
    for (std::vector<float>& plane : m_camera)
        plane.resize(std::size_t(width) * std::size_t(height));
}

void CameraFrame::put(const RgbView& scene, Site origin, Illegal& illegal)
{
    const auto [width, height] = m_simulation.frame();
    if (origin.row < 0 || origin.col < 0 || origin.row + scene.height > height
        || origin.col + scene.width > width)
        throw Error("pixels at row " + std::to_string(origin.row) + ", column "
                    + std::to_string(origin.col) + " are outside the image");
    const std::ptrdiff_t offset = std::ptrdiff_t(origin.row) * width + origin.col;
    std::array<Plane<float>, 3> part;
    for (std::size_t i = 0; i < 3; ++i)
        part[i] = { m_camera[i].data() + offset, scene.width, scene.height, width };
    m_simulation.m_state->to_camera_rgb(scene, part, illegal);
}

void CameraFrame::complete()
{
    const Simulation::State& state = *m_simulation.m_state;
    if (!state.stages.needs_glare_context())
        return;
    std::array<Plane<const float>, 3> camera;
    for (std::size_t i = 0; i < 3; ++i)
        camera[i] = { m_camera[i].data(), state.frame.width, state.frame.height,
                      state.frame.width };
    m_glare_context = glare_context_of(camera);
    state.stages.pass_color(
        *m_glare_context,
        { state.frame, state.profile.cfa, state.light.neutral, {}, nullptr });
}

void CameraFrame::each_piece(int first, int rows, Result result,
                             const ParallelFor& parallel,
                             const std::function<void(const Piece&)>& done) const
{
    const Simulation::State& state = *m_simulation.m_state;
    const int width = state.frame.width, reach = m_simulation.reach();
    const int across = (width + block_side - 1) / block_side;
    const int down = (rows + block_side - 1) / block_side;
    parallel(across * down, [&](int task) {
        const int row = task / across * block_side, col = task % across * block_side;
        const Part inner { { first + row, col },
                           { std::min(block_side, width - col),
                             std::min(block_side, rows - row) } };
        const Part outer = around(inner, state.frame, reach);
        Band band;
        band.resize(outer.size.width, outer.size.height);
        for (std::size_t i = 0; i < 3; ++i)
            copy_part(m_camera[i], width, outer, band.camera[i]);
        state.run_stages(
            band, outer.first, m_glare_context ? &*m_glare_context : nullptr,
            result == Result::simulation ? Purpose::drawing : Purpose::prediction);
        const int top = inner.first.row - outer.first.row;
        const int left = inner.first.col - outer.first.col;
        for (int i = 0; i < inner.size.height; ++i)
            done({ { inner.first.row + i, inner.first.col },
                   inner.size.width,
                   band.mosaic.row(top + i) + left,
                   band.variance.row(top + i) + left });
    });
}

void CameraFrame::simulate(int first, const Plane<std::uint16_t>& raw,
                           const ParallelFor& parallel) const
{
    each_piece(first, raw.height, Result::simulation, parallel, [&](const Piece& p) {
        digitise(p.signal, m_simulation.m_state->levels, p.at, p.count,
                 raw.row(p.at.row - first) + p.at.col);
    });
}

void CameraFrame::simulate(int first, const Plane<float>& signal,
                           const ParallelFor& parallel) const
{
    each_piece(first, signal.height, Result::simulation, parallel, [&](const Piece& p) {
        std::copy_n(p.signal, p.count, signal.row(p.at.row - first) + p.at.col);
    });
}

void CameraFrame::predict(int first, const Plane<float>& mean,
                          const Plane<float>& variance,
                          const ParallelFor& parallel) const
{
    each_piece(first, mean.height, Result::prediction, parallel, [&](const Piece& p) {
        std::copy_n(p.signal, p.count, mean.row(p.at.row - first) + p.at.col);
        std::copy_n(p.variance, p.count, variance.row(p.at.row - first) + p.at.col);
    });
}

} // namespace cg2raw

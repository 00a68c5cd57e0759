// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/prediction.h"

#include "run_stages.h"

#include <algorithm>
#include <optional>

namespace cg2raw {
namespace {

std::string text_of(Size size)
{
    return std::to_string(size.height) + " x " + std::to_string(size.width);
}

Size size_of(const Plane<const float>& plane) { return { plane.width, plane.height }; }

void check_inside(const PredictedBlock& block, Size frame)
{
    const auto [row, col] = block.origin;
    const Size size = block.size;
    const Size given = size_of(block.camera[0]);
    if (row < 0 || col < 0 || row + size.height > frame.height
        || col + size.width > frame.width || given.height > frame.height
        || given.width > frame.width)
        throw Error("block of " + text_of(size) + " pixels at row "
                    + std::to_string(row) + ", col " + std::to_string(col)
                    + " leaves the frame of " + text_of(frame)
                    + ": origins and margins lie inside");
}

/// Where the frame ends with the block, effects mirror as they do in the whole frame;
/// elsewhere the margin has what they reach.
void check_margin(const PredictedBlock& block, Size frame, int margin, int reach)
{
    const Size size = size_of(block.camera[0]);
    const Site first = first_of_block(block.origin, size, margin, frame);
    const auto is_short = [&](int inner, int begin, int count, int length, int whole) {
        const bool before = begin > 0 && inner - begin < reach;
        const bool after
            = begin + length < whole && begin + length - inner - count < reach;
        return before || after;
    };
    if (is_short(block.origin.row, first.row, block.size.height, size.height,
                 frame.height)
        || is_short(block.origin.col, first.col, block.size.width, size.width,
                    frame.width))
        throw Error("margin " + std::to_string(margin) + " is less than the "
                    + std::to_string(reach)
                    + " pixels that the effects reach together: give at least that");
}

/// The block with no more of its margin than effects reach.
PredictedBlock narrowed(PredictedBlock block, Size frame, int margin, int reach)
{
    const Size given = size_of(block.camera[0]);
    const Size size { std::min(block.size.width + 2 * reach, given.width),
                      std::min(block.size.height + 2 * reach, given.height) };
    const Site before = first_of_block(block.origin, given, margin, frame);
    const Site first = first_of_block(block.origin, size, reach, frame);
    for (Plane<const float>& plane : block.camera) {
        plane.data = plane.row(first.row - before.row) + first.col - before.col;
        plane.width = size.width;
        plane.height = size.height;
    }
    return block;
}

/// Blocks up to this have room that their thread keeps from call to call.
constexpr int most_kept = 1 << 18;

void copy_inner(const Plane<float>& from, Site first, const Plane<float>& to)
{
    for (int row = 0; row < to.height; ++row)
        std::copy_n(from.row(first.row + row) + first.col, to.width, to.row(row));
}

/// All stages on a block with its margin.
void predict(const Stages& stages, const Exposure& exposure,
             const PredictedBlock& block, int margin)
{
    const Size size = size_of(block.camera[0]);
    const Site origin = first_of_block(block.origin, size, margin, exposure.frame);
    thread_local Band kept;
    Band large;
    Band& band = std::ptrdiff_t(size.width) * size.height > most_kept ? large : kept;
    band.resize(size.width, size.height);
    for (std::size_t plane = 0; plane < 3; ++plane)
        for (int row = 0; row < size.height; ++row)
            std::copy_n(block.camera[plane].row(row), size.width,
                        band.camera[plane].row(row));
    stages.on_camera(band.camera, origin, exposure, Purpose::prediction);
    band.to_mosaic(stages.cfa, origin);
    // The plane of red is free from here on: it takes the signal before its noise.
    stages.on_mosaic(band.mosaic, band.variance, band.noise, origin, exposure,
                     Purpose::prediction, &band.camera[0]);
    const Site first { block.origin.row - origin.row, block.origin.col - origin.col };
    copy_inner(band.mosaic, first, block.mean);
    copy_inner(band.variance, first, block.variance);
    copy_inner(band.camera[0], first, block.exposed);
}

} // namespace

Site first_of_block(Site origin, Size block, int margin, Size frame)
{
    return {
        std::clamp(origin.row - margin, 0, std::max(frame.height - block.height, 0)),
        std::clamp(origin.col - margin, 0, std::max(frame.width - block.width, 0))
    };
}

void predict_blocks(const SensorProfile& profile,
                    const std::vector<NamedValues>& settings, const Exposure& given,
                    const std::vector<PredictedBlock>& blocks, int margin,
                    const ParallelFor& parallel)
{
    Run run;
    run.convention = Convention::sensor;
    const Stages stages(profile, run, active_effects(profile, settings));
    check_needs(stages.active, given);
    Exposure exposure = given;
    std::optional<GlareContext> glare_context;
    if (given.glare_context && stages.needs_glare_context()) {
        glare_context = *given.glare_context;
        stages.pass_color(*glare_context, given);
        exposure.glare_context = &*glare_context;
    }
    const int reach = reach_of(stages.active, Stage::color, Stage::processing);
    for (const PredictedBlock& block : blocks) {
        check_inside(block, exposure.frame);
        check_margin(block, exposure.frame, margin, reach);
    }
    const int needed = std::min(margin, reach);
    parallel(int(blocks.size()), [&](int i) {
        const PredictedBlock& block = blocks[std::size_t(i)];
        predict(stages, exposure, narrowed(block, exposure.frame, margin, needed),
                needed);
    });
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/prediction.h"

#include "stages.h"

#include <algorithm>

namespace cg2raw {
namespace {

std::string text_of(Size size)
{
    return std::to_string(size.height) + " x " + std::to_string(size.width);
}

void check_inside(const PredictedBlock& block, Size frame)
{
    const auto [row, col] = block.origin;
    const Size size { block.camera[0].width, block.camera[0].height };
    if (row < 0 || col < 0 || row + size.height > frame.height
        || col + size.width > frame.width)
        throw Error("block of " + text_of(size) + " pixels at row "
                    + std::to_string(row) + ", col " + std::to_string(col)
                    + " leaves the frame of " + text_of(frame)
                    + ": origins and margins lie inside");
}

/// Where the frame ends with the block, effects mirror as they do in the whole frame.
void check_margin(const PredictedBlock& block, Size frame, int margin, int reach)
{
    const auto [row, col] = block.origin;
    const bool whole = row == 0 && col == 0 && block.camera[0].width == frame.width
        && block.camera[0].height == frame.height;
    if (margin < reach && !whole)
        throw Error("margin " + std::to_string(margin) + " is less than the "
                    + std::to_string(reach)
                    + " pixels that the effects reach together: give at least that");
}

/// Blocks up to this have room that their thread keeps from call to call.
constexpr int most_kept = 1 << 18;

void copy_inner(const Plane<float>& from, int margin, const Plane<float>& to)
{
    for (int row = 0; row < to.height; ++row)
        std::copy_n(from.row(margin + row) + margin, to.width, to.row(row));
}

void predict(const Stages& stages, const Exposure& exposure,
             const PredictedBlock& block, int margin)
{
    const auto& [origin, camera, mean, variance, exposed] = block;
    const int width = camera[0].width, height = camera[0].height;
    thread_local Band kept;
    Band large;
    Band& band = std::ptrdiff_t(width) * height > most_kept ? large : kept;
    band.resize(width, height);
    for (std::size_t plane = 0; plane < 3; ++plane)
        for (int row = 0; row < height; ++row)
            std::copy_n(camera[plane].row(row), width, band.camera[plane].row(row));
    stages.on_camera(band.camera, origin, exposure, Purpose::prediction);
    band.to_mosaic(stages.cfa, origin);
    // The plane of red is free from here on.
    stages.on_mosaic(band.mosaic, band.variance, band.noise, origin, exposure,
                     Purpose::prediction, &band.camera[0]);
    copy_inner(band.mosaic, margin, mean);
    copy_inner(band.variance, margin, variance);
    copy_inner(band.camera[0], margin, exposed);
}

} // namespace

void predict_blocks(const SensorProfile& profile,
                    const std::vector<NamedValues>& settings, const Exposure& exposure,
                    const std::vector<PredictedBlock>& blocks, int margin,
                    const ParallelFor& parallel)
{
    const Stages stages(profile, active_effects(profile, settings));
    check_needs(stages.active, exposure);
    const int reach = reach_of(stages.active, Stage::color, Stage::output);
    for (const PredictedBlock& block : blocks) {
        check_inside(block, exposure.frame);
        check_margin(block, exposure.frame, margin, reach);
    }
    parallel(int(blocks.size()),
             [&](int i) { predict(stages, exposure, blocks[std::size_t(i)], margin); });
}

} // namespace cg2raw

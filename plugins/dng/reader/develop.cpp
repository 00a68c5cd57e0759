// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file A picture of a DNG by the core's own demosaicking and colours.
#include "cg2raw/dng_mosaic.h"

#include "cg2raw/demosaic.h"
#include "cg2raw/transform.h"
#include "tiff/tag_numbers.h"

#include <algorithm>

namespace cg2raw {
namespace {

/// Rows of DN that are held beside the picture.
constexpr int held_rows = 256;

/// The result of @p work, whose error gets the file's name.
template <class Work> auto named(const DngMetadata& metadata, const Work& work)
{
    try {
        return work();
    } catch (const Error& error) {
        throw Error(metadata.file + ": " + error.what());
    }
}

/// Of the file's own matrices and neutral.
SceneTransform transform_of(const DngMetadata& metadata)
{
    SensorProfile profile {};
    profile.id = metadata.file;
    profile.cfa = metadata.cfa;
    profile.calibrations = metadata.calibrations;
    const bool mono = metadata.cfa.is_mono();
    const bool has_matrix = !metadata.calibrations.empty();
    if (!mono && !(has_matrix && metadata.as_shot_neutral))
        throw Error(text_of(has_matrix ? tag::as_shot_neutral : tag::color_matrix_1)
                    + " is missing; without it nothing can be developed: read the "
                      "mosaic instead");
    const Illuminant light
        = illuminant(profile, mono ? "" : "as-shot", metadata.as_shot_neutral);
    return scene_from_camera(camera_from_scene(profile, light, Convention::dng));
}

} // namespace

struct DevelopedDng::State {
    explicit State(DngMosaic& source)
        : mosaic(source)
        , metadata(source.metadata())
        , size(metadata.active_area)
        , demosaic(named(metadata, [&] { return Demosaic(metadata.cfa, size); }))
        , transform(named(metadata, [&] { return transform_of(metadata); }))
    {
    }

    Plane<const float> plane() const
    {
        return { signal.data(), size.width, size.height, size.width };
    }

    /// DN -> 0 for black to 1 for white, of the active area.
    void read_signal(const ParallelFor& parallel)
    {
        if (!signal.empty())
            return;
        const DngStorage& storage = mosaic.storage();
        std::vector<float> values(std::size_t(size.width) * std::size_t(size.height));
        std::vector<std::uint16_t> dn;
        for (int first = 0; first < size.height; first += held_rows) {
            const int count = std::min(held_rows, size.height - first);
            dn.resize(std::size_t(storage.size.width) * std::size_t(count));
            const Plane<std::uint16_t> rows { dn.data(), storage.size.width, count,
                                              storage.size.width };
            mosaic.read_rows(storage.active_area.row + first, rows, parallel);
            for (int row = 0; row < count; ++row)
                normalise(rows.row(row) + storage.active_area.col, first + row,
                          values.data()
                              + std::size_t(first + row) * std::size_t(size.width));
        }
        signal = std::move(values);
    }

    /// Source: DNG specification 1.7.1, "Mapping Raw Values to Linear Reference
    /// Values": each pixel's own black, and one scale by the largest of them.
    void normalise(const std::uint16_t* dn, int row, float* out) const
    {
        const BlackByPixel& black = metadata.black;
        const double range = metadata.white_level - black.largest;
        for (int col = 0; col < size.width; ++col)
            out[col] = float((dn[col] - black.at({ row, col })) / range);
    }

    /// Row @p row as R, G, B.
    void develop(int row, float* rgb) const
    {
        const std::size_t width = std::size_t(size.width);
        std::vector<float> room(9 * width);
        float* planes[6];
        for (std::size_t i = 0; i < 6; ++i)
            planes[i] = room.data() + i * width;
        float* const pixels = room.data() + 6 * width;
        demosaic.row(plane(), row, planes);
        for (std::size_t col = 0; col < width; ++col)
            for (std::size_t c = 0; c < 3; ++c)
                pixels[3 * col + c] = planes[c][col];
        Illegal illegal;
        to_scene(transform, pixels, 3, size.width, planes + 3, illegal);
        for (std::size_t col = 0; col < width; ++col)
            for (std::size_t c = 0; c < 3; ++c)
                rgb[3 * col + c] = planes[3 + c][col];
    }

    DngMosaic& mosaic;
    const DngMetadata& metadata;
    Size size;
    Demosaic demosaic;
    SceneTransform transform;
    std::vector<float> signal; ///< of the active area; empty: not read
};

DevelopedDng::DevelopedDng(DngMosaic& mosaic)
    : m_state(std::make_unique<State>(mosaic))
{
}

DevelopedDng::~DevelopedDng() = default;

Size DevelopedDng::size() const { return m_state->size; }

void DevelopedDng::read_rows(int first, int count, float* rgb, std::ptrdiff_t pitch,
                             const ParallelFor& parallel)
{
    if (first < 0 || count < 0 || count > m_state->size.height - first)
        throw Error(m_state->metadata.file + ": rows " + std::to_string(first) + " to "
                    + std::to_string(first + count) + " are not among the picture's "
                    + std::to_string(m_state->size.height));
    m_state->read_signal(parallel);
    parallel(count, [&](int row) {
        m_state->develop(first + row, rgb + std::ptrdiff_t(row) * pitch);
    });
}

} // namespace cg2raw

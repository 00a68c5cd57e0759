// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The raw IFD's geometry and levels: active area, CFA, black, white.
#include "reader/metadata_parts.h"
#include "reader/profile_parts.h"

#include <algorithm>
#include <sstream>

namespace cg2raw {
namespace {

constexpr Bounds image_side { 2, 65535 };
constexpr Bounds cfa_side { 1, 6 };
/// As wide a repeat as raw converters accept.
constexpr Bounds black_side { 1, 8 };
constexpr int widest_sample = 16;

struct Rectangle {
    std::int64_t top, left, bottom, right;
};

Rectangle read_active_area(const TiffTags& raw)
{
    const auto width = raw.integers(tag::image_width, { 1, 1 }, image_side).front();
    const auto height = raw.integers(tag::image_length, { 1, 1 }, image_side).front();
    if (!raw.has(tag::active_area))
        return { 0, 0, height, width };
    const auto area = raw.integers(tag::active_area, { 4, 4 }, { 0, image_side.high });
    const Rectangle result { area[0], area[1], area[2], area[3] };
    if (result.bottom > height || result.right > width
        || result.bottom - result.top < image_side.low
        || result.right - result.left < image_side.low) {
        std::ostringstream what;
        what << "is " << area[0] << " " << area[1] << " " << area[2] << " " << area[3]
             << " (top, left, bottom, right); it must hold 2 x 2 pixels or more inside "
                "the "
             << width << " x " << height << " image: use another DNG of this camera";
        raw.fail(tag::active_area, what.str());
    }
    return result;
}

/// Samples of a pixel, each with levels of its own.
constexpr std::int64_t linear_planes = 3;

std::int64_t planes_of(const TiffTags& raw)
{
    return is_linear(raw) ? linear_planes : 1;
}

void check_planes(const TiffTags& raw)
{
    const std::int64_t planes = planes_of(raw);
    raw.integer_or(tag::samples_per_pixel, { planes, planes }, 1);
    if (raw.integer_or(tag::sample_format, { 1, 4 }, 1) == 3)
        raw.fail(tag::sample_format,
                 "is 3, floating point; only unsigned integers (1) are"
                 " read: use the camera's own DNG");
    if (raw.integer_or(tag::cfa_layout, { 1, 9 }, 1) != 1)
        raw.fail(tag::cfa_layout,
                 "is not 1 (rectangular); staggered sensors have no model"
                 " here");
    if (raw.has(tag::cfa_plane_color)) {
        const auto colors = raw.bytes(tag::cfa_plane_color, { 1, 16 });
        if (colors != std::vector<std::uint8_t> { 0, 1, 2 })
            raw.fail(tag::cfa_plane_color,
                     "is not 0 1 2: only sensors of red, green and"
                     " blue, in this order, have a model here");
    }
}

/// The phase starts at the corner of the active area (DNG specification, ActiveArea).
CfaPattern read_cfa(const TiffTags& raw, const std::optional<CfaPattern>& of_linear)
{
    if (of_linear)
        return *of_linear;
    if (raw.integer_or(tag::photometric, { 0, 65535 }, 0) == photometric::linear_raw)
        return mono_cfa();
    const auto dim = raw.integers(tag::cfa_repeat_pattern_dim, { 2, 2 }, cfa_side);
    CfaPattern cfa;
    cfa.height = int(dim[0]);
    cfa.width = int(dim[1]);
    const auto colors = raw.bytes(tag::cfa_pattern, { cfa.sites(), cfa.sites() });
    std::copy(colors.begin(), colors.end(), cfa.colors.begin());
    for (std::uint8_t color : colors)
        if (color > 2)
            raw.fail(
                tag::cfa_pattern,
                "has colour " + std::to_string(color)
                    + "; allowed: 0 (red), 1 (green), 2 (blue): other sensors have no"
                      " model here");
    for (std::uint8_t color : { 0, 1, 2 })
        if (std::find(colors.begin(), colors.end(), color) == colors.end())
            raw.fail(tag::cfa_pattern,
                     "lacks colour " + std::to_string(color)
                         + "; it must have red (0), green (1) and blue (2)");
    return cfa;
}

/// Of a demosaicked image the least of its planes': all of them saturate there.
int read_white_level(const TiffTags& raw)
{
    const std::int64_t planes = planes_of(raw);
    const Bounds dn { 1, (1 << widest_sample) - 1 };
    if (raw.has(tag::white_level)) {
        const auto levels = raw.integers(tag::white_level, { 1, planes }, dn);
        return int(*std::min_element(levels.begin(), levels.end()));
    }
    const auto bits
        = raw.integers(tag::bits_per_sample, { 1, planes }, { 8, widest_sample });
    return (1 << bits.front()) - 1;
}

int bits_of(int white_level)
{
    int bits = 8;
    while ((1 << bits) <= white_level)
        ++bits;
    return bits;
}

/// BlackLevel on its own repeat, rows x cols x planes, row major.
struct BlackPattern {
    std::int64_t rows, cols, planes;
    std::vector<double> dn;
};

BlackPattern read_black_pattern(const TiffTags& raw, DngMetadata& metadata)
{
    std::vector<std::int64_t> dim { 1, 1 };
    if (raw.has(tag::black_level_repeat_dim))
        dim = raw.integers(tag::black_level_repeat_dim, { 2, 2 }, black_side);
    const std::int64_t planes = planes_of(raw), count = dim[0] * dim[1] * planes;
    if (raw.has(tag::black_level))
        return { dim[0], dim[1], planes,
                 raw.numbers(tag::black_level, { count, count }) };
    metadata.notes.push_back(text_of(tag::black_level)
                             + " is missing: 0, the specification's default");
    return { dim[0], dim[1], planes, std::vector<double>(std::size_t(count), 0.0) };
}

/// A value per column or row; empty if the file has none.
std::vector<double> read_deltas(const TiffTags& raw, TiffTag delta, std::int64_t side,
                                DngMetadata& metadata)
{
    if (!raw.has(delta))
        return {};
    const auto values = raw.numbers(delta, { side, side });
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    if (*high > *low)
        metadata.notes.push_back(text_of(delta) + " varies black by "
                                 + rounded_text(*high - *low)
                                 + " DN from line to line: a developed picture has"
                                   " each, a profile the mean per CFA site");
    return values;
}

/// Of the values at each @p phases-th place; zeros if there are none.
template <class Reduce>
std::vector<double> per_phase(const std::vector<double>& values, std::int64_t phases,
                              const Reduce& reduce)
{
    std::vector<double> result;
    for (std::size_t phase = 0; phase < std::size_t(phases); ++phase) {
        std::vector<double> of_phase;
        for (std::size_t i = phase; i < values.size(); i += std::size_t(phases))
            of_phase.push_back(values[i]);
        result.push_back(of_phase.empty() ? 0.0 : reduce(of_phase));
    }
    return result;
}

double largest_of(const std::vector<double>& values)
{
    return *std::max_element(values.begin(), values.end());
}

/// Of all pixels: each meets its columns' and rows' largest somewhere.
double largest_black(const BlackByPixel& black)
{
    const auto by_col = per_phase(black.by_col, black.cols, largest_of);
    const auto by_row = per_phase(black.by_row, black.rows, largest_of);
    double largest = black.pattern.front() + by_row.front() + by_col.front();
    for (int row = 0; row < black.rows; ++row)
        for (int col = 0; col < black.cols; ++col)
            largest
                = std::max(largest,
                           black.pattern[std::size_t(row * black.cols + col)]
                               + by_row[std::size_t(row)] + by_col[std::size_t(col)]);
    return largest;
}

/// The mean of the black pattern over the pixels of one CFA site: of its own plane, of
/// an image that has all at each pixel.
double mean_black(const BlackPattern& black, const CfaPattern& cfa, Site site)
{
    const std::int64_t plane = black.planes == 1 ? 0 : cfa.color(site);
    double sum = 0.0;
    for (std::int64_t r = 0; r < black.rows; ++r)
        for (std::int64_t c = 0; c < black.cols; ++c) {
            const std::int64_t row = (site.row + r * cfa.height) % black.rows;
            const std::int64_t col = (site.col + c * cfa.width) % black.cols;
            sum += black.dn[std::size_t((row * black.cols + col) * black.planes
                                        + plane)];
        }
    return sum / double(black.rows * black.cols);
}

void read_black_level(const TiffTags& raw, DngMetadata& metadata)
{
    const CfaPattern& cfa = metadata.cfa;
    const BlackPattern black = read_black_pattern(raw, metadata);
    metadata.black = {
        int(black.rows),
        int(black.cols),
        black.planes == 1 ? black.dn : std::vector<double> {},
        read_deltas(raw, tag::black_level_delta_h, metadata.active_area.width,
                    metadata),
        read_deltas(raw, tag::black_level_delta_v, metadata.active_area.height,
                    metadata),
        0.0,
    };
    const auto by_col = per_phase(metadata.black.by_col, cfa.width, mean_of);
    const auto by_row = per_phase(metadata.black.by_row, cfa.height, mean_of);
    for (int row = 0; row < cfa.height; ++row)
        for (int col = 0; col < cfa.width; ++col) {
            const double dn = mean_black(black, cfa, { row, col })
                + by_col[std::size_t(col)] + by_row[std::size_t(row)];
            if (!(dn >= 0.0 && dn < metadata.white_level)) {
                std::ostringstream what;
                what << "is " << dn << " DN at CFA site " << row << ", " << col
                     << "; it must be at least 0 and below "
                     << text_of(tag::white_level) << " " << metadata.white_level
                     << " DN: use another DNG of this camera";
                raw.fail(tag::black_level, what.str());
            }
            metadata.black_level.push_back(dn);
        }
    if (cfa.height % black.rows != 0 || cfa.width % black.cols != 0)
        metadata.notes.push_back(text_of(tag::black_level) + " repeats over "
                                 + std::to_string(black.rows) + " x "
                                 + std::to_string(black.cols)
                                 + " pixels: a developed picture has each, a profile"
                                   " the mean per CFA site");
    if (metadata.black.pattern.empty())
        return;
    metadata.black.largest = largest_black(metadata.black);
    if (!(metadata.black.largest < metadata.white_level))
        raw.fail(tag::black_level,
                 "and its deltas reach " + rounded_text(metadata.black.largest)
                     + " DN; black must be below " + text_of(tag::white_level) + " "
                     + std::to_string(metadata.white_level)
                     + " DN: use another DNG of this camera");
}

} // namespace

double BlackByPixel::at(Site pixel) const
{
    double dn = pattern[std::size_t(pixel.row % rows * cols + pixel.col % cols)];
    if (!by_col.empty())
        dn += by_col[std::size_t(pixel.col)];
    if (!by_row.empty())
        dn += by_row[std::size_t(pixel.row)];
    return dn;
}

void read_dng_levels(const TiffTags& raw,
                     const std::optional<CfaPattern>& cfa_of_linear,
                     DngMetadata& metadata)
{
    check_planes(raw);
    const Rectangle area = read_active_area(raw);
    metadata.active_area = { int(area.right - area.left), int(area.bottom - area.top) };
    metadata.cfa = read_cfa(raw, cfa_of_linear);
    metadata.white_level = read_white_level(raw);
    metadata.bits = bits_of(metadata.white_level);
    read_black_level(raw, metadata);
    if (raw.has(tag::linearization_table))
        metadata.notes.push_back(text_of(tag::linearization_table)
                                 + ": black, white and bits are"
                                   " those of the linearised values");
}

} // namespace cg2raw

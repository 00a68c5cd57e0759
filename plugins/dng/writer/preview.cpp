// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "writer/preview.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cg2raw {

namespace {

constexpr int longest_side = 1024;
/// Steps of the sRGB curve: 0.4 codes apart where it is steepest.
constexpr int curve_steps = 8192;

/// Source: IEC 61966-2-1.
double srgb_code(double linear)
{
    return linear <= 0.0031308 ? 12.92 * linear
                               : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

std::vector<std::uint8_t> srgb_curve()
{
    std::vector<std::uint8_t> curve;
    for (int i = 0; i < curve_steps; ++i)
        curve.push_back(std::uint8_t(
            std::lround(255.0 * srgb_code(double(i) / (curve_steps - 1)))));
    return curve;
}

/// The smallest multiple of the repeat by which @p size shrinks to longest_side; on a
/// side that is shorter, all of it.
Size block_of(Size size, const CfaPattern& cfa)
{
    const int repeat = std::lcm(cfa.width, cfa.height);
    const int longest = std::max(size.width, size.height);
    const int block
        = (longest + longest_side * repeat - 1) / (longest_side * repeat) * repeat;
    return { std::min(block, size.width / cfa.width * cfa.width),
             std::min(block, size.height / cfa.height * cfa.height) };
}

} // namespace

Preview::Preview(const DngDescription& description)
    : m_cfa(description.cfa)
    , m_width(description.size.width)
    , m_block(block_of(description.size, description.cfa))
    , m_size { m_width / m_block.width, description.size.height / m_block.height }
    , m_curve(srgb_curve())
    , m_sums(std::size_t(m_cfa.height) * std::size_t(m_width))
{
    std::copy_n(description.srgb_from_balanced.m.begin(), 9,
                m_srgb_from_balanced.begin());
    std::array<int, 3> sites_of_color {};
    for (int site = 0; site < m_cfa.sites(); ++site)
        ++sites_of_color[m_cfa.colors[std::size_t(site)]];
    const Vec3& neutral = description.as_shot_neutral;
    const int sums = m_block.width / m_cfa.width * (m_block.height / m_cfa.height);
    for (int site = 0; site < m_cfa.sites(); ++site) {
        const int color = m_cfa.colors[std::size_t(site)];
        const double black = description.black_level[std::size_t(site)];
        const double gain = max_of(neutral) / neutral[std::size_t(color)];
        const double range = (description.white_level - black) * sums
            * sites_of_color[std::size_t(color)];
        m_sites.push_back({ color, float(gain / range), float(black * sums) });
    }
}

const std::vector<std::uint8_t>&
Preview::add_rows(const Plane<const std::uint16_t>& rows, const ParallelFor& parallel)
{
    const int first_row = std::min(m_row / m_block.height, m_size.height);
    const int end_row = std::min((m_row + rows.height) / m_block.height, m_size.height);
    m_pixels.resize(3 * std::size_t(m_size.width) * std::size_t(end_row - first_row));
    const int in_block = m_row % m_block.height;
    const int head
        = in_block == 0 ? 0 : std::min(rows.height, m_block.height - in_block);
    const auto part = [&](int first, int count) {
        return Plane<const std::uint16_t> { rows.data + first * rows.pitch, rows.width,
                                            count, rows.pitch };
    };
    add(part(0, head), in_block, m_sums);
    m_row += head;
    if (head > 0 && m_row % m_block.height == 0) {
        finish(m_sums, m_row / m_block.height - 1 - first_row);
        std::fill(m_sums.begin(), m_sums.end(), 0);
    }
    const int whole = (rows.height - head) / m_block.height;
    parallel(whole, [&](int i) {
        Sums sums(m_sums.size());
        add(part(head + i * m_block.height, m_block.height), 0, sums);
        finish(sums, m_row / m_block.height + i - first_row);
    });
    const int tail = head + whole * m_block.height;
    add(part(tail, rows.height - tail), 0, m_sums);
    m_row += rows.height - head;
    return m_pixels;
}

void Preview::add(const Plane<const std::uint16_t>& rows, int first, Sums& sums) const
{
    const int width = m_width; // a local: the sums might else be taken to change it
    for (int row = 0; row < rows.height; ++row) {
        const std::uint16_t* const from = rows.row(row);
        std::uint32_t* const to
            = sums.data() + std::ptrdiff_t((first + row) % m_cfa.height) * width;
        for (int col = 0; col < width; ++col)
            to[col] += from[col];
    }
}

void Preview::finish(const Sums& sums, int row)
{
    const std::size_t at = 3 * std::size_t(row) * std::size_t(m_size.width);
    if (at >= m_pixels.size())
        return; // below the picture
    CameraRow camera = balanced(sums);
    render(camera, m_pixels.data() + at);
}

Preview::CameraRow Preview::balanced(const Sums& sums) const
{
    CameraRow camera;
    camera.fill(std::vector<float>(std::size_t(m_size.width)));
    std::vector<std::uint32_t> of_site(std::size_t(m_size.width));
    for (std::size_t site = 0; site < m_sites.size(); ++site) {
        const int row = int(site) / m_cfa.width;
        const int col = int(site) % m_cfa.width;
        const std::uint32_t* const from = sums.data() + std::ptrdiff_t(row) * m_width;
        std::fill(of_site.begin(), of_site.end(), 0);
        for (int at = col; at < m_block.width; at += m_cfa.width)
            for (int i = 0; i < m_size.width; ++i)
                of_site[std::size_t(i)] += from[i * m_block.width + at];
        const SiteScale scale = m_sites[site];
        float* const out = camera[std::size_t(scale.color)].data();
        for (std::size_t i = 0; i < of_site.size(); ++i)
            out[i] += (float(std::int32_t(of_site[i])) - scale.black) * scale.per_dn;
    }
    if (m_cfa.is_mono())
        camera[0] = camera[2] = camera[1];
    return camera;
}

void Preview::render(CameraRow& camera, std::uint8_t* out) const
{
    const auto clipped = [](float x) { return x < 0.0F ? 0.0F : x > 1.0F ? 1.0F : x; };
    const int width = m_size.width;
    // Saturated channels would tint highlights: white is where all are.
    for (std::vector<float>& channel : camera)
        for (float& x : channel)
            x = clipped(x);
    const float* const r = camera[0].data();
    const float* const g = camera[1].data();
    const float* const b = camera[2].data();
    std::vector<int> steps(camera[0].size());
    int* const step = steps.data();
    for (int c = 0; c < 3; ++c) {
        const float* const from = m_srgb_from_balanced.data() + 3 * std::ptrdiff_t(c);
        const float from_r = from[0], from_g = from[1], from_b = from[2];
        for (int i = 0; i < width; ++i) {
            const float linear = from_r * r[i] + from_g * g[i] + from_b * b[i];
            step[i] = int(clipped(linear) * (curve_steps - 1) + 0.5F);
        }
        const std::uint8_t* const curve = m_curve.data();
        for (int i = 0; i < width; ++i)
            out[3 * i + c] = curve[step[i]];
    }
}

} // namespace cg2raw

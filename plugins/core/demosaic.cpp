// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/demosaic.h"

#include <algorithm>
#include <cstdlib>

namespace cg2raw {
namespace {

/// Sums are float64: weights are small whole numbers, so that the mean of equal values
/// is that value to the last bit.
template <class Tap>
float mean_of(const std::vector<Tap>& taps, const Plane<const float>& raw, Site at)
{
    double sum = 0.0, weights = 0.0;
    for (const Tap& tap : taps) {
        sum += double(tap.weight) * raw({ at.row + tap.row, at.col + tap.col });
        weights += tap.weight;
    }
    return float(sum / weights);
}

} // namespace

Demosaic::Demosaic(const CfaPattern& cfa, Size size)
    : m_cfa(cfa)
    , m_size(size)
    , m_radius(0)
    , m_taps(std::size_t(cfa.sites()))
{
    if (size.width < cfa.width || size.height < cfa.height)
        throw Error("mosaic of " + std::to_string(size.height) + " x "
                    + std::to_string(size.width)
                    + " pixels must hold a whole repeat of the CFA, "
                    + std::to_string(cfa.height) + " x " + std::to_string(cfa.width));
    if (cfa.is_mono())
        return; // every site has all that there is
    // One repeat away from the border, where no row or column is negative.
    const auto place = [&](int site) {
        return Site { cfa.height + site / cfa.width, cfa.width + site % cfa.width };
    };
    const auto complete = [&] {
        return std::all_of(m_taps.begin(), m_taps.end(), [](const auto& colors) {
            return std::none_of(colors.begin(), colors.end(),
                                [](const Taps& taps) { return taps.empty(); });
        });
    };
    while (!complete()) {
        ++m_radius;
        for (int site = 0; site < cfa.sites(); ++site)
            for (int color = 0; color < 3; ++color)
                m_taps[std::size_t(site)][std::size_t(color)]
                    = taps(place(site), color, m_radius);
    }
}

Demosaic::Taps Demosaic::taps(Site at, int color, int radius) const
{
    Taps taps;
    for (int row = -radius; row <= radius; ++row)
        for (int col = -radius; col <= radius; ++col) {
            const Site site { at.row + row, at.col + col };
            if (site.row >= 0 && site.col >= 0 && m_cfa.color(site) == color)
                taps.push_back({ row, col,
                                 float((radius + 1 - std::abs(row))
                                       * (radius + 1 - std::abs(col))) });
        }
    return taps;
}

/// Near the border: of the sites inside the image, in a tent that grows until it has
/// one.
float Demosaic::mean_around(const Plane<const float>& raw, Site at, int color) const
{
    for (int radius = m_radius;; ++radius) {
        Taps inside = taps(at, color, radius);
        inside.erase(std::remove_if(inside.begin(), inside.end(),
                                    [&](const Tap& tap) {
                                        return at.row + tap.row >= m_size.height
                                            || at.col + tap.col >= m_size.width;
                                    }),
                     inside.end());
        if (!inside.empty())
            return mean_of(inside, raw, at);
    }
}

void Demosaic::row(const Plane<const float>& raw, int row, float* const camera[3]) const
{
    if (m_cfa.is_mono()) {
        for (int color = 0; color < 3; ++color)
            std::copy_n(raw.row(row), m_size.width, camera[color]);
        return;
    }
    const bool row_inside = row >= m_radius && row + m_radius < m_size.height;
    for (int col = 0; col < m_size.width; ++col) {
        const Site at { row, col };
        const bool inside
            = row_inside && col >= m_radius && col + m_radius < m_size.width;
        const int site = row % m_cfa.height * m_cfa.width + col % m_cfa.width;
        for (int color = 0; color < 3; ++color)
            camera[color][col] = color == m_cfa.color(at) ? raw(at)
                : inside
                ? mean_of(m_taps[std::size_t(site)][std::size_t(color)], raw, at)
                : mean_around(raw, at, color);
    }
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "digitise.h"

#include "multiversion.h"

#include <algorithm>
#include <cmath>

namespace cg2raw {
namespace {

/// Pixels per piece; a piece and its normals stay in the first-level cache.
constexpr int piece = 256;

CG2RAW_MULTIVERSION void add_scaled(const float* variance, const float* normal,
                                    int count, float* noise)
{
    for (int i = 0; i < count; ++i)
        noise[i] += std::sqrt(std::max(variance[i], 0.0f)) * normal[i];
}

CG2RAW_MULTIVERSION void add_below(const float* noise, int count, float ceiling,
                                   float* mean)
{
    for (int i = 0; i < count; ++i)
        mean[i] += mean[i] < ceiling ? noise[i] : 0.0f;
}

/// Rounds half up.
inline std::uint16_t dn_of(float signal, float black, float white)
{
    const float level = signal * (white - black) + black;
    return std::uint16_t(std::int32_t(std::min(std::max(level, 0.0f), white) + 0.5f));
}

/// Alternating black levels.
CG2RAW_MULTIVERSION void digitise_bayer(const float* signal, float black_even,
                                        float black_odd, float white, int width,
                                        std::uint16_t* dn)
{
    const float black[2] = { black_even, black_odd };
    for (int col = 0; col < width; ++col)
        dn[col] = dn_of(signal[col], black[col & 1], white);
}

float black_at(const Levels& levels, Site at)
{
    const int site
        = at.row % levels.cfa.height * levels.cfa.width + at.col % levels.cfa.width;
    return levels.black[std::size_t(site)];
}

} // namespace

Levels levels_of(const SensorProfile& profile)
{
    Levels levels { profile.cfa, {}, float(profile.white_level) };
    std::copy(profile.black_level.begin(), profile.black_level.end(),
              levels.black.begin());
    return levels;
}

void add_gaussian(const Rng& rng, Site origin, const Plane<float>& variance,
                  const Plane<float>& noise)
{
    float normal[piece];
    for (int row = 0; row < noise.height; ++row)
        for (int col = 0; col < noise.width; col += piece) {
            const int count = std::min(piece, noise.width - col);
            rng.normals({ origin.row + row, origin.col + col }, count, normal);
            add_scaled(variance.row(row) + col, normal, count, noise.row(row) + col);
        }
}

void add_noise(const Plane<float>& noise, float ceiling, const Plane<float>& mean)
{
    for (int row = 0; row < mean.height; ++row)
        add_below(noise.row(row), mean.width, ceiling, mean.row(row));
}

void digitise(const float* signal, const Levels& levels, Site at, int width,
              std::uint16_t* dn)
{
    if (levels.cfa.width == 2) {
        digitise_bayer(signal, black_at(levels, at),
                       black_at(levels, { at.row, at.col + 1 }), levels.white, width,
                       dn);
        return;
    }
    for (int phase = 0; phase < levels.cfa.width; ++phase) {
        const float black = black_at(levels, { at.row, at.col + phase });
        for (int col = phase; col < width; col += levels.cfa.width)
            dn[col] = dn_of(signal[col], black, levels.white);
    }
}

void undo_digitise(const std::uint16_t* dn, const Levels& levels, Site at, int width,
                   float* signal)
{
    for (int phase = 0; phase < levels.cfa.width; ++phase) {
        const float black = black_at(levels, { at.row, at.col + phase });
        const float range = levels.white - black;
        for (int col = phase; col < width; col += levels.cfa.width)
            signal[col] = (float(dn[col]) - black) / range;
    }
}

} // namespace cg2raw

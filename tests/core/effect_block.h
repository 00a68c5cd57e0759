// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file A block of a planted frame, for tests of single effects without a pipeline.
#pragma once

#include "cg2raw/effect.h"

#include <cmath>

namespace cg2raw::test {

/// Signal 0.05 ... 1.15 and variance up to 0.01, of the site alone: a frame's block has
/// the same pixels as the frame.
class EffectBlock {
public:
    EffectBlock(const Effect& effect, Size frame, Site origin, Size size)
        : m_size(size)
        , m_pixels(std::size_t(5 * size.width * size.height))
    {
        const int planes = effect.stage <= Stage::optics ? 3 : 1;
        signal.planes = planes;
        for (std::size_t i = 0; i < std::size_t(planes); ++i)
            signal.mean[i] = planted(int(i), origin, 0.05, 1.1);
        if (planes == 1) {
            signal.variance = planted(3, origin, 0.0, 0.01);
            signal.noise = planted(4, origin, 0.0, 0.0);
        }
        signal.origin = origin;
        signal.exposure = { frame, cfa_from_name("grbg"), { 0.6, 1.0, 0.8 }, 2.0 };
        for (std::vector<float>& wide : m_glare_context.wide)
            for (int i = 0; i < 20; ++i)
                wide.push_back(0.02f * float((7 * i) % 20));
        signal.exposure.glare_context = &m_glare_context;
    }
    EffectBlock(const EffectBlock&) = delete;

    /// Mean, variance and noise of a pixel, those that there are, in one row.
    std::vector<float> at(Site site) const
    {
        std::vector<float> values;
        for (std::size_t i = 0; i < std::size_t(signal.planes); ++i)
            values.push_back(signal.mean[i](site));
        if (signal.planes == 1)
            values.insert(values.end(), { signal.variance(site), signal.noise(site) });
        return values;
    }
    std::vector<float> all() const
    {
        std::vector<float> values;
        for (int row = 0; row < m_size.height; ++row)
            for (int col = 0; col < m_size.width; ++col)
                for (float value : at({ row, col }))
                    values.push_back(value);
        return values;
    }

    Signal signal {};

private:
    Plane<float> planted(int which, Site origin, double least, double range)
    {
        const auto [width, height] = m_size;
        const Plane<float> plane { m_pixels.data() + which * width * height, width,
                                   height, width };
        const Rng rng(1, "content", std::uint64_t(which));
        std::vector<double> uniform(static_cast<std::size_t>(width));
        for (int row = 0; row < height; ++row) {
            rng.uniforms({ origin.row + row, origin.col }, width, uniform.data());
            for (int col = 0; col < width; ++col)
                plane.row(row)[col] = float(least + range * uniform[std::size_t(col)]);
        }
        return plane;
    }

    Size m_size;
    std::vector<float> m_pixels;
    GlareContext m_glare_context { { 5, 4 }, {}, { 0.3, 0.4, 0.2 } };
};

inline Values null_values(const Effect& effect)
{
    Values values;
    for (const Parameter& parameter : effect.parameters)
        values.push_back(parameter.null);
    return values;
}

/// The way from null to the farther bound.
inline double way(const Parameter& parameter)
{
    const double up = parameter.max - parameter.null;
    const double down = parameter.min - parameter.null;
    return up >= -down ? up : down;
}

/// Every parameter at a tenth of its way.
inline Values strong_values(const Effect& effect)
{
    Values values = null_values(effect);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] += 0.1 * way(effect.parameters[i]);
    return values;
}

} // namespace cg2raw::test

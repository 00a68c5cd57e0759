// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file From the GainMaps of real files to the parameters of the effect color_shading:
/// red and blue over green, by least squares. A factor for the whole frame is fitted
/// along and left out: it is part of the white balance.
#include "reader/gain_maps.h"
#include "reader/least_squares.h"

#include <cmath>

namespace cg2raw {
namespace {

/// A factor for the frame, and the terms of color_shading_at() in its order.
using Equations = LeastSquares<5>;

/// What gains that were rounded to floats differ by.
constexpr double rounding = 1e-5;
/// Maps that differ in another way than the effect can leave more than this of it.
constexpr double most_left = 0.5;

Equations::Row terms_at(Place at, Size size)
{
    const FieldOffset offset = field_offset(at, size);
    const double square = offset.u * offset.u + offset.v * offset.v;
    return { 1.0, square, square * square, offset.u, offset.v };
}

using OverGreen = float ShadingAt::*;

/// Adds the parameters of a colour and the squares of what there was and what is left;
/// false if the points do not determine them.
bool add_color(const GainMapSamples& samples, Size size, OverGreen color,
               ColorShadingFit& fit)
{
    Equations equations;
    double mean = 0.0;
    for (const ShadingAt& point : samples.points) {
        const double ratio = double(point.*color);
        equations.add(terms_at(place_of(samples, point), size), ratio);
        mean += ratio / double(samples.points.size());
    }
    const auto solution = equations.solved();
    if (!solution || !((*solution)[0] > 0.0))
        return false;
    for (std::size_t i = 1; i < solution->size(); ++i)
        fit.values.push_back((*solution)[i] / (*solution)[0]);
    for (const ShadingAt& point : samples.points) {
        const Equations::Row terms = terms_at(place_of(samples, point), size);
        const double ratio = double(point.*color);
        fit.departure += (ratio / mean - 1.0) * (ratio / mean - 1.0);
        double left = ratio;
        for (std::size_t i = 0; i < terms.size(); ++i)
            left -= terms[i] * (*solution)[i];
        fit.rms += left * left / (ratio * ratio);
    }
    return true;
}

} // namespace

FieldOffset field_offset(Place at, Size size)
{
    const double half = std::hypot(size.width, size.height) / 2.0;
    return { (at.h - 0.5) * size.width / half, (at.v - 0.5) * size.height / half };
}

std::optional<ColorShadingFit> color_shading_fit(const GainMapSamples& samples,
                                                 Size size)
{
    ColorShadingFit fit;
    if (!add_color(samples, size, &ShadingAt::red, fit)
        || !add_color(samples, size, &ShadingAt::blue, fit))
        return std::nullopt;
    const double count = 2.0 * double(samples.points.size());
    fit.departure = std::sqrt(fit.departure / count);
    fit.rms = std::sqrt(fit.rms / count);
    if (!(fit.departure > rounding && fit.rms <= most_left * fit.departure))
        return std::nullopt;
    return fit;
}

} // namespace cg2raw

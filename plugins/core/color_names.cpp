// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file How files say that their pixels are scene-linear Rec.709.
#include "cg2raw/color.h"

#include "text.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace cg2raw {
namespace {

/// Names that OpenImageIO and common configs give to scene-linear Rec.709.
constexpr const char* rec709_names[] = { "lin_rec709",
                                         "lin_rec709_scene",
                                         "lin_srgb",
                                         "lin_srgb_scene",
                                         "lin_rec709_srgb",
                                         "srgb_linear",
                                         "linear srgb",
                                         "linear rec.709 (srgb)",
                                         "linear rec.709",
                                         "utility - linear - srgb",
                                         "utility - linear - rec.709" };
/// Red, green, blue and white of Rec.709. Source: IEC 61966-2-1.
constexpr double rec709_primaries[8]
    = { 0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290 };
/// Renderers write these numbers with three or four decimals.
constexpr double primaries_tolerance = 0.002;

} // namespace

bool is_rec709_name(std::string_view space)
{
    const std::string name = lower_case(space);
    return std::find(std::begin(rec709_names), std::end(rec709_names), name)
        != std::end(rec709_names);
}

bool is_rec709_primaries(const std::array<double, 8>& chromaticities)
{
    for (std::size_t i = 0; i < 8; ++i)
        if (!(std::abs(chromaticities[i] - rec709_primaries[i]) < primaries_tolerance))
            return false;
    return true;
}

} // namespace cg2raw

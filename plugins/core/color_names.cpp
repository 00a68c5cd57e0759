// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file How files say that their pixels are scene-linear Rec.709.
#include "cg2raw/color.h"

#include "cg2raw/types.h"
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
using Chromaticities = std::array<double, 8>;

/// Red, green, blue and white of Rec.709. Source: IEC 61966-2-1.
constexpr Chromaticities rec709_primaries { 0.64, 0.33, 0.30,   0.60,
                                            0.15, 0.06, 0.3127, 0.3290 };
/// Others that renderers work in, by their names in OpenColorIO's configs.
constexpr struct {
    const char* name;
    Chromaticities primaries;
} other_primaries[] = {
    // Source: ACES S-2014-004
    { "ACEScg", { 0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767 } },
    // Source: SMPTE ST 2065-1
    { "ACES2065-1", { 0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.32168, 0.33767 } },
    // Source: ITU-R BT.2020
    { "lin_rec2020", { 0.708, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290 } },
    // Source: SMPTE EG 432-1
    { "lin_p3d65", { 0.680, 0.320, 0.265, 0.690, 0.150, 0.060, 0.3127, 0.3290 } },
};
/// Renderers write these numbers with three or four decimals.
constexpr double primaries_tolerance = 0.002;

bool are_same(const Chromaticities& a, const Chromaticities& b)
{
    for (std::size_t i = 0; i < a.size(); ++i)
        if (!(std::abs(a[i] - b[i]) < primaries_tolerance))
            return false;
    return true;
}

/// Whether OpenImageIO's reader of OpenEXR says @p space of any file, whatever its
/// primaries: then nobody has stated it. Measured with 2.4.7, 3.0.21, 3.1.19, 3.2.2.
bool says_nothing(std::string_view space, int openimageio_version)
{
    if (space.empty())
        return true;
    if (openimageio_version < 30000 && space == "Linear")
        return true;
    return openimageio_version >= 20500 && openimageio_version < 30100
        && (space == "lin_rec709" || space == "lin_srgb");
}

} // namespace

bool is_rec709_name(std::string_view space)
{
    const std::string name = lower_case(space);
    return std::find(std::begin(rec709_names), std::end(rec709_names), name)
        != std::end(rec709_names);
}

bool is_rec709_primaries(const std::array<double, 8>& chromaticities)
{
    return are_same(chromaticities, rec709_primaries);
}

void require_rec709_primaries(const std::array<double, 8>& chromaticities,
                              std::string_view space, int openimageio_version,
                              const std::string& rec709)
{
    if (is_rec709_primaries(chromaticities)
        || !says_nothing(space, openimageio_version))
        return;
    std::string whose = "unknown", from = "NAME";
    for (const auto& other : other_primaries)
        if (are_same(chromaticities, other.primaries))
            whose = "those of " + std::string(other.name), from = other.name;
    const bool stays_unclear = says_nothing(rec709, openimageio_version);
    throw Error("its chromaticities are " + whose
                + ", not Rec.709's: convert it by oiiotool "
                  "--iscolorspace "
                + from + " --tocolorspace \"" + rec709 + "\""
                + (stays_unclear ? " --eraseattrib chromaticities" : ""));
}

} // namespace cg2raw

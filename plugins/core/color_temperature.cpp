// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Robertson's isotherms, both ways.
#include "cg2raw/color.h"
#include "cg2raw/types.h"
#include "text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace cg2raw {
namespace {

/// A line of equal temperature in the CIE 1960 uv diagram.
struct Isotherm {
    double mired, u, v, slope;
};

/// Source: Wyszecki & Stiles, Color Science, 2nd ed., table 1(3.11).
constexpr std::array<Isotherm, 31> isotherms { {
    { 0, 0.18006, 0.26352, -0.24341 },   { 10, 0.18066, 0.26589, -0.25479 },
    { 20, 0.18133, 0.26846, -0.26876 },  { 30, 0.18208, 0.27119, -0.28539 },
    { 40, 0.18293, 0.27407, -0.30470 },  { 50, 0.18388, 0.27709, -0.32675 },
    { 60, 0.18494, 0.28021, -0.35156 },  { 70, 0.18611, 0.28342, -0.37915 },
    { 80, 0.18740, 0.28668, -0.40955 },  { 90, 0.18880, 0.28997, -0.44278 },
    { 100, 0.19032, 0.29326, -0.47888 }, { 125, 0.19462, 0.30141, -0.58204 },
    { 150, 0.19962, 0.30921, -0.70471 }, { 175, 0.20525, 0.31647, -0.84901 },
    { 200, 0.21142, 0.32312, -1.0182 },  { 225, 0.21807, 0.32909, -1.2168 },
    { 250, 0.22511, 0.33439, -1.4512 },  { 275, 0.23247, 0.33904, -1.7298 },
    { 300, 0.24010, 0.34308, -2.0637 },  { 325, 0.24702, 0.34655, -2.4681 },
    { 350, 0.25591, 0.34951, -2.9641 },  { 375, 0.26400, 0.35200, -3.5814 },
    { 400, 0.27218, 0.35407, -4.3633 },  { 425, 0.28039, 0.35577, -5.3762 },
    { 450, 0.28863, 0.35714, -6.7262 },  { 475, 0.29685, 0.35823, -8.5955 },
    { 500, 0.30505, 0.35907, -11.324 },  { 525, 0.31320, 0.35968, -15.628 },
    { 550, 0.32129, 0.36011, -23.325 },  { 575, 0.32931, 0.36038, -40.770 },
    { 600, 0.33724, 0.36051, -116.45 },
} };

Isotherm isotherm(std::size_t index, RobertsonTable table)
{
    Isotherm line = isotherms[index];
    if (line.mired == 325 && table == RobertsonTable::corrected)
        line.u = 0.24792;
    return line;
}

/// Distance of (u, v) from a line, positive on the warmer side.
double distance(const Isotherm& line, double u, double v)
{
    return ((v - line.v) - line.slope * (u - line.u)) / std::hypot(1.0, line.slope);
}

} // namespace

Temperature temperature_from_xy(Chromaticity xy, RobertsonTable table)
{
    const double scale = 1.5 - xy.x + 6.0 * xy.y;
    const double u = 2.0 * xy.x / scale;
    const double v = 3.0 * xy.y / scale;
    std::size_t warm = 1; // the first line that is warmer than the point
    double beyond = distance(isotherm(1, table), u, v);
    double before = 0.0;
    while (warm < isotherms.size() - 1 && beyond > 0.0) {
        before = beyond;
        beyond = distance(isotherm(++warm, table), u, v);
    }
    beyond = -std::min(beyond, 0.0);
    const double to_cool = warm == 1 ? 0.0 : beyond / (before + beyond);
    const Isotherm a = isotherm(warm - 1, table), b = isotherm(warm, table);
    const double mired = a.mired * to_cool + b.mired * (1.0 - to_cool);

    // Direction of the isotherm at the point, interpolated between unit vectors.
    const double length_a = std::hypot(1.0, a.slope),
                 length_b = std::hypot(1.0, b.slope);
    const double du = to_cool / length_a + (1.0 - to_cool) / length_b;
    const double dv
        = a.slope / length_a * to_cool + b.slope / length_b * (1.0 - to_cool);
    const double length = std::hypot(du, dv);
    const double off_u = u - (a.u * to_cool + b.u * (1.0 - to_cool));
    const double off_v = v - (a.v * to_cool + b.v * (1.0 - to_cool));
    return { { 1e6 / mired }, -(off_u * du + off_v * dv) / length };
}

Chromaticity planckian_xy(Kelvin cct)
{
    if (!(cct.value >= 1667.0 && cct.value <= 25000.0))
        throw Error("temperature " + number(cct.value)
                    + " K is outside 1667 to 25000 K");
    const double mired = 1e6 / cct.value;
    std::size_t warm = 1;
    while (warm < isotherms.size() - 1 && isotherms[warm].mired < mired)
        ++warm;
    const Isotherm a = isotherm(warm - 1, RobertsonTable::corrected);
    const Isotherm b = isotherm(warm, RobertsonTable::corrected);
    const double weight = (mired - a.mired) / (b.mired - a.mired);
    const double u = a.u + weight * (b.u - a.u);
    const double v = a.v + weight * (b.v - a.v);
    const double scale = u - 4.0 * v + 2.0;
    return { 1.5 * u / scale, v / scale };
}

} // namespace cg2raw

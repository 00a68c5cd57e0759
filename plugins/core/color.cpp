// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/color.h"

#include "cg2raw/types.h"
#include "text.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace cg2raw {

Mat3 operator*(const Mat3& a, const Mat3& b)
{
    Mat3 product {};
    for (int row = 0; row < 3; ++row)
        for (int col = 0; col < 3; ++col)
            product(row, col)
                = a(row, 0) * b(0, col) + a(row, 1) * b(1, col) + a(row, 2) * b(2, col);
    return product;
}

Vec3 operator*(const Mat3& a, const Vec3& v)
{
    Vec3 product {};
    for (int row = 0; row < 3; ++row)
        product[std::size_t(row)]
            = a(row, 0) * v[0] + a(row, 1) * v[1] + a(row, 2) * v[2];
    return product;
}

Mat3 diagonal(const Vec3& v) { return { { v[0], 0, 0, 0, v[1], 0, 0, 0, v[2] } }; }

Mat3 inverse(const Mat3& a)
{
    Mat3 adjugate {};
    for (int row = 0; row < 3; ++row)
        for (int col = 0; col < 3; ++col) {
            const int r1 = (col + 1) % 3, r2 = (col + 2) % 3;
            const int c1 = (row + 1) % 3, c2 = (row + 2) % 3;
            adjugate(row, col) = a(r1, c1) * a(r2, c2) - a(r1, c2) * a(r2, c1);
        }
    const double determinant = a(0, 0) * adjugate(0, 0) + a(0, 1) * adjugate(1, 0)
        + a(0, 2) * adjugate(2, 0);
    if (!(std::abs(determinant) > 1e-12) || !std::isfinite(determinant))
        throw Error("matrix is singular (determinant " + number(determinant) + ")");
    for (double& value : adjugate.m)
        value /= determinant;
    return adjugate;
}

Mat3 row_normalised(const Mat3& a)
{
    Mat3 result {};
    for (int row = 0; row < 3; ++row) {
        const double sum = a(row, 0) + a(row, 1) + a(row, 2);
        if (!(std::abs(sum) > 1e-12))
            throw Error("matrix row " + std::to_string(row) + " sums to 0");
        for (int col = 0; col < 3; ++col)
            result(row, col) = a(row, col) / sum;
    }
    return result;
}

Mat3 mixed(const Mat3& a, const Mat3& b, double weight)
{
    Mat3 result {};
    for (std::size_t i = 0; i < 9; ++i)
        result.m[i] = a.m[i] + weight * (b.m[i] - a.m[i]);
    return result;
}

double max_of(const Vec3& v) { return std::max({ v[0], v[1], v[2] }); }

Vec3 xyz_from_xy(Chromaticity xy)
{
    const double y = std::max(xy.y, 1e-6);
    return { xy.x / y, 1.0, (1.0 - xy.x - y) / y };
}

Chromaticity xy_from_xyz(const Vec3& xyz)
{
    const double sum = xyz[0] + xyz[1] + xyz[2];
    if (!(sum > 0.0))
        return d50_white;
    return { xyz[0] / sum, xyz[1] / sum };
}

Mat3 bradford(Chromaticity to, Chromaticity from)
{
    const Mat3 cone_from_xyz = { { 0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367,
                                   0.0389, -0.0685, 1.0296 } };
    const Vec3 cone_to = cone_from_xyz * xyz_from_xy(to);
    const Vec3 cone_from = cone_from_xyz * xyz_from_xy(from);
    const Vec3 scale { cone_to[0] / cone_from[0], cone_to[1] / cone_from[1],
                       cone_to[2] / cone_from[2] };
    return inverse(cone_from_xyz) * diagonal(scale) * cone_from_xyz;
}

Mat3 xyz_d65_from_srgb()
{
    const Vec3 red = xyz_from_xy({ 0.64, 0.33 });
    const Vec3 green = xyz_from_xy({ 0.30, 0.60 });
    const Vec3 blue = xyz_from_xy({ 0.15, 0.06 });
    const Mat3 primaries = { { red[0], green[0], blue[0], red[1], green[1], blue[1],
                               red[2], green[2], blue[2] } };
    return primaries * diagonal(inverse(primaries) * xyz_from_xy(d65_white));
}

Mat3 xyz_d50_from_srgb()
{
    return bradford(d50_white, d65_white) * xyz_d65_from_srgb();
}

} // namespace cg2raw

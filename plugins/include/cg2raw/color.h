// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Colours that belong to no camera: xy, XYZ, temperature, adaptation, 3x3
/// algebra. All of it is float64. A matrix is named to_from, so that inner names
/// cancel.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

namespace cg2raw {

using Vec3 = std::array<double, 3>;

/// 3x3 matrix, row major.
struct Mat3 {
    std::array<double, 9> m;

    double operator()(int row, int col) const { return m[std::size_t(3 * row + col)]; }
    double& operator()(int row, int col) { return m[std::size_t(3 * row + col)]; }
};

struct Kelvin {
    double value; ///< correlated colour temperature
};

struct Chromaticity {
    double x, y; ///< CIE 1931, 2 degree observer
};

/// White of the DNG profile connection space. Source: DNG specification 1.7, chapter 6.
constexpr Chromaticity d50_white { 0.3457, 0.3585 };
/// White of sRGB. Source: IEC 61966-2-1.
constexpr Chromaticity d65_white { 0.3127, 0.3290 };

Mat3 operator*(const Mat3& a, const Mat3& b);
Vec3 operator*(const Mat3& a, const Vec3& v);
Mat3 diagonal(const Vec3& v);
/// Throws Error if the matrix is singular or not finite.
Mat3 inverse(const Mat3& a);
/// Each row divided by its sum, so that (1, 1, 1) maps to itself. Throws Error on a sum
/// of 0.
Mat3 row_normalised(const Mat3& a);
/// Linear interpolation a + weight (b - a).
Mat3 mixed(const Mat3& a, const Mat3& b, double weight);
double max_of(const Vec3& v);

/// XYZ with Y = 1 of a chromaticity; y is kept above 1e-6.
Vec3 xyz_from_xy(Chromaticity xy);
/// Chromaticity of XYZ; D50 for black.
Chromaticity xy_from_xyz(const Vec3& xyz);

/// Temperature of a light and its distance from the Planckian locus.
struct Temperature {
    Kelvin cct;
    double duv; ///< CIE 1960 uv, positive above the locus (greenish)
};

/// Which value Robertson's isotherm of 325 mired has for u.
enum class RobertsonTable {
    adobe, ///< 0.24702, as raw converters have it: parity with them
    corrected, ///< 0.24792, the published table's corrected value
};

/// Correlated colour temperature by Robertson's isotherms (31 lines, 0 to 600 mired).
/// Outside the table the last isotherm answers: 1667 K at the warm end.
/// Source: A. R. Robertson, J. Opt. Soc. Am. 58(11), 1968.
Temperature temperature_from_xy(Chromaticity xy, RobertsonTable table);

/// Chromaticity of the black body at @p cct, 1667 to 25000 K, by the corrected table:
/// the inverse of temperature_from_xy. Throws Error outside that range.
Chromaticity planckian_xy(Kelvin cct);

/// Linear Bradford adaptation of XYZ from one white to another.
/// Source: DNG specification 1.7, chapter 6 (K. M. Lam, 1985).
Mat3 bradford(Chromaticity to, Chromaticity from);

/// XYZ (D65, Y = 1) from linear sRGB/Rec.709, from the primaries of IEC 61966-2-1.
Mat3 xyz_d65_from_srgb();
/// The same, adapted to D50 by Bradford.
Mat3 xyz_d50_from_srgb();

/// Whether a colour space's name is one that OpenImageIO or a common config gives to
/// scene-linear Rec.709; upper and lower case do not matter.
bool is_rec709_name(std::string_view space);
/// Whether (x, y) of red, green, blue and white are those of Rec.709, at 0.002.
bool is_rec709_primaries(const std::array<double, 8>& chromaticities);
/// Throws Error, with the command that converts it, for an image of other primaries.
/// They are a file's, and a conversion leaves them behind: a stated @p space, by any
/// name but those that the OpenEXR reader of that OpenImageIO (2.4.7 is 20407) gives to
/// every file, is believed instead. @p rec709 is the name to convert to.
void require_rec709_primaries(const std::array<double, 8>& chromaticities,
                              std::string_view space, int openimageio_version,
                              const std::string& rec709);

} // namespace cg2raw

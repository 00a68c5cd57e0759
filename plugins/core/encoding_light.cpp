// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Numbers of a file -> light.
#include "cg2raw/encoding.h"

#include "elementary.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace cg2raw {
namespace {

/// What float's rounding may move a code value by, in parts of it: twice the half unit
/// in the last place of float32, in hosts that multiply by the rounded reciprocal.
constexpr double code_tolerance = 0x1p-22;
/// Above it a float is no code, and its power may be none.
constexpr double largest = 1e15;

/// Source: IEC 61966-2-1.
double srgb_power(double code)
{
    return exponential(2.4 * natural_log((code + 0.055) / 1.055));
}

double srgb_light(double code)
{
    return code <= 0.04045 ? code / 12.92 : srgb_power(code);
}

double curve_light(const Curve& curve, double code)
{
    if (curve.kind == Curve::Kind::none || !(std::abs(code) < largest))
        return code;
    if (curve.kind == Curve::Kind::srgb)
        return srgb_light(code);
    return code > 0.0 ? exponential(curve.exponent * natural_log(code)) : 0.0;
}

/// srgb_power() from 2^-5 to 2, but for parts of 2^-41: Taylor polynomials of degree 4,
/// in 64 steps for each power of two. With r = |code - centre| / (centre + 0.055) below
/// 2^-7, what is left out is 0.011 r^5 and less.
class SrgbPieces {
public:
    SrgbPieces()
    {
        for (std::size_t i = 0; i < m_pieces.size(); ++i) {
            Piece& piece = m_pieces[i];
            const double start = std::ldexp(1.0, int(i / steps) + least_exponent);
            piece.centre = start * (1.0 + (double(i % steps) + 0.5) / steps);
            piece.factors[0] = srgb_power(piece.centre);
            for (std::size_t k = 0; k < degree; ++k)
                piece.factors[k + 1] = piece.factors[k] * (2.4 - double(k))
                    / (double(k + 1) * (piece.centre + 0.055));
        }
    }

    /// @p code is at least 2^-5 and below 2.
    double light(double code) const
    {
        std::uint64_t bits = 0;
        std::memcpy(&bits, &code, sizeof bits);
        const Piece& piece = m_pieces[std::size_t((bits >> mantissa_shift) - first)];
        const double by = code - piece.centre;
        double sum = piece.factors[degree];
        for (std::size_t k = degree; k > 0; --k)
            sum = sum * by + piece.factors[k - 1];
        return sum;
    }

private:
    static constexpr std::size_t steps = 64, degree = 4;
    static constexpr int least_exponent = -5, powers = 6;
    /// A double has 52 bits of mantissa, here the last six of its index, and 1023 added
    /// to its exponent.
    static constexpr unsigned mantissa_shift = 52 - 6;
    static constexpr std::uint64_t first = std::uint64_t(1023 + least_exponent) * steps;

    struct Piece {
        double centre;
        std::array<double, degree + 1> factors;
    };
    std::array<Piece, steps * powers> m_pieces {};
};

/// float(curve_light()), bit for bit: fast where a polynomial leaves no doubt of it.
float rounded_light(const Curve& curve, double code)
{
    constexpr double doubt = 0x1p-40;
    if (curve.kind == Curve::Kind::srgb && code > 0.04045 && code < 2.0) {
        static const SrgbPieces pieces;
        const double light = pieces.light(code);
        const float low = float(light * (1.0 - doubt));
        if (low == float(light * (1.0 + doubt)))
            return low;
    }
    return float(curve_light(curve, code));
}

} // namespace

Decoder::Decoder(const Curve& curve, Alpha alpha, int levels)
    : m_curve(curve)
    , m_alpha(alpha)
    , m_needs_alpha(alpha == Alpha::unassociated
                    || (alpha == Alpha::associated && curve.kind != Curve::Kind::none))
    , m_top(levels > 0 ? levels - 1 : 0)
{
    if (m_top == 0)
        return;
    m_light.reserve(std::size_t(levels));
    for (int code = 0; code < levels; ++code)
        m_light.push_back(float(curve_light(curve, double(code) / m_top)));
}

bool Decoder::is_identity() const
{
    return m_curve.kind == Curve::Kind::none && !m_needs_alpha && m_top == 0;
}

/// The code value that a number is, but for rounding; -1 if it is none.
int Decoder::code_of(float number) const
{
    if (m_top == 0)
        return -1;
    const double code = double(number) * m_top, whole = std::nearbyint(code);
    const bool is_code = whole >= 0.0 && whole <= m_top
        && std::abs(code - whole) <= whole * code_tolerance;
    return is_code ? int(whole) : -1;
}

double Decoder::value_of(float number) const
{
    const int code = code_of(number);
    return code < 0 ? double(number) : double(code) / m_top;
}

float Decoder::light_of(float number) const
{
    const int code = code_of(number);
    return code < 0 ? rounded_light(m_curve, number) : m_light[std::size_t(code)];
}

void Decoder::decode(float* rgb, const float* alpha, std::ptrdiff_t pitch,
                     int count) const
{
    for (int i = 0; i < count; ++i, rgb += 3) {
        const float a = m_needs_alpha ? float(value_of(alpha[i * pitch])) : 1.0F;
        const bool is_clear = m_alpha == Alpha::unassociated && !(a > 0.0F);
        const bool is_divided = m_alpha == Alpha::associated && a > 0.0F && a < 1.0F;
        for (int color = 0; color < 3; ++color) {
            float& number = rgb[color];
            if (is_clear)
                number = 0.0F;
            else if (is_divided)
                number = rounded_light(m_curve, value_of(number) / double(a)) * a;
            else if (m_alpha == Alpha::unassociated)
                number = light_of(number) * a;
            else
                number = light_of(number);
        }
    }
}

} // namespace cg2raw

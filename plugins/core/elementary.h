// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Logarithm and exponential of ours, float64: where they decide pixels, libm's
/// would differ between machines. Written so that loops over them vectorise.
#pragma once

#include <cstdint>
#include <cstring>

namespace cg2raw {

/// Natural logarithm of a normal x > 0; relative error below 4e-16.
/// By 2 artanh((m - 1) / (m + 1)) with the mantissa m in 0.707 ... 1.414.
inline double natural_log(double x)
{
    std::int64_t bits = 0;
    std::memcpy(&bits, &x, sizeof bits);
    // 0x3FE6A09E are the upper bits of sqrt(1/2).
    const std::int32_t exponent = (std::int32_t(bits >> 32) - 0x3FE6A09E) >> 20;
    bits -= std::int64_t(std::uint64_t(std::int64_t(exponent)) << 52);
    double mantissa = 0.0;
    std::memcpy(&mantissa, &bits, sizeof mantissa);
    const double s = (mantissa - 1.0) / (mantissa + 1.0), square = s * s;
    double p = 1.0 / 21.0;
    p = p * square + 1.0 / 19.0;
    p = p * square + 1.0 / 17.0;
    p = p * square + 1.0 / 15.0;
    p = p * square + 1.0 / 13.0;
    p = p * square + 1.0 / 11.0;
    p = p * square + 1.0 / 9.0;
    p = p * square + 1.0 / 7.0;
    p = p * square + 1.0 / 5.0;
    p = p * square + 1.0 / 3.0;
    const double log_2_high = 0x1.62e42fefa38p-1, log_2_low = 0x1.ef35793c7673p-45;
    const double low = double(exponent) * log_2_low + 2.0 * s * square * p;
    return double(exponent) * log_2_high + (2.0 * s + low);
}

/// e^x for -700 <= x <= 700; relative error below 4e-16. By Taylor's series of the
/// remainder of a division by ln 2.
inline double exponential(double x)
{
    const double shift = 0x1.8p52; // adding it rounds to a whole number
    const double shifted = x * 0x1.71547652b82fep0 + shift, whole = shifted - shift;
    const double r = (x - whole * 0x1.62e42fefa38p-1) - whole * 0x1.ef35793c7673p-45;
    double p = 1.0 / 6227020800.0; // 1 / 13!
    p = p * r + 1.0 / 479001600.0;
    p = p * r + 1.0 / 39916800.0;
    p = p * r + 1.0 / 3628800.0;
    p = p * r + 1.0 / 362880.0;
    p = p * r + 1.0 / 40320.0;
    p = p * r + 1.0 / 5040.0;
    p = p * r + 1.0 / 720.0;
    p = p * r + 1.0 / 120.0;
    p = p * r + 1.0 / 24.0;
    p = p * r + 1.0 / 6.0;
    p = p * r + 0.5;
    p = p * r * r + r + 1.0;
    std::int64_t bits = 0; // the whole number stands in the last bits of shifted
    std::memcpy(&bits, &shifted, sizeof bits);
    bits = std::int64_t((std::uint64_t(bits) + 1023u) << 52);
    double scale = 0.0;
    std::memcpy(&scale, &bits, sizeof scale);
    return p * scale;
}

} // namespace cg2raw

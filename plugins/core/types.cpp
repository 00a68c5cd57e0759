// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/types.h"

#include "multiversion.h"
#include "text.h"

#include <cstring>

namespace cg2raw {
namespace {

inline float float_of(std::uint32_t bits)
{
    float value = 0.0f;
    std::memcpy(&value, &bits, sizeof value);
    return value;
}

/// Source: IEEE 754: 5 bits of exponent, bias 15, 10 of fraction, against 8, 127, 23.
/// A subnormal is put behind a leading 1, which is subtracted again; no subnormal float
/// takes part, whatever the processor is told to do with those.
inline float float_of_half(std::uint32_t half)
{
    constexpr std::uint32_t to_bias = (127 - 15) << 23, one = 1u << 23;
    const std::uint32_t moved = (half & 0x7fff) << 13;
    const std::uint32_t exponent = half & 0x7c00;
    const float normal = float_of(moved + to_bias + (exponent == 0x7c00 ? to_bias : 0));
    const float subnormal = float_of(moved + to_bias + one) - float_of(to_bias + one);
    const float magnitude = exponent == 0 ? subnormal : normal;
    return half & 0x8000 ? -magnitude : magnitude;
}

} // namespace

Error::Error(std::string_view message)
    : std::runtime_error(one_line(message, longest_message))
{
}

CG2RAW_MULTIVERSION void float_from_half(const std::uint16_t* half, int count,
                                         float* out)
{
    for (int i = 0; i < count; ++i)
        out[i] = float_of_half(half[i]);
}

} // namespace cg2raw

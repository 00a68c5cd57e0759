// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "tiff/tag_values.h"

#include "cg2raw/types.h"

#include <cmath>
#include <limits>

namespace cg2raw {

namespace {

template <class Integer> Integer rounded(double value, Integer denominator)
{
    const double numerator = std::round(value * double(denominator));
    if (!(numerator >= double(std::numeric_limits<Integer>::min())
          && numerator <= double(std::numeric_limits<Integer>::max())))
        throw Error("DNG: " + std::to_string(value) + " does not fit a fraction of "
                    + std::to_string(denominator) + " in 32 bits");
    return Integer(numerator);
}

} // namespace

Rational rational(double value, std::uint32_t denominator)
{
    return { rounded(value, denominator), denominator };
}

SignedRational signed_rational(double value, std::int32_t denominator)
{
    return { rounded(value, denominator), denominator };
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Tags of one IFD as values, before a TIFF writer sees them.
#pragma once

#include "tiff/tag_numbers.h"

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace cg2raw {

/// RATIONAL, or SRATIONAL in a vector of its own type.
struct Rational {
    std::uint32_t numerator, denominator;
};
struct SignedRational {
    std::int32_t numerator, denominator;
};

/// @p value rounded to 1 / @p denominator. Throws Error if it leaves 32 bits.
Rational rational(double value, std::uint32_t denominator);
SignedRational signed_rational(double value, std::int32_t denominator);

using Bytes = std::vector<std::uint8_t>;
/// UNDEFINED: bytes without a type of their own.
struct Undefined {
    Bytes bytes;
};

/// The alternative decides the TIFF type.
using TagValue
    = std::variant<std::string, Bytes, Undefined, std::vector<std::uint16_t>,
                   std::vector<std::uint32_t>, std::vector<float>, std::vector<double>,
                   std::vector<Rational>, std::vector<SignedRational>>;

struct Tag {
    Tag(TiffTag tag, TagValue tag_value)
        : number(tag.number)
        , value(std::move(tag_value))
    {
    }

    std::uint32_t number;
    TagValue value;
};
using Tags = std::vector<Tag>;

} // namespace cg2raw

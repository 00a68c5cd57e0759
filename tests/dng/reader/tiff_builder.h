// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file DNGs made of nothing but tags, in either byte order, for tests of the reader.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace cg2raw::test {

/// A tag's values as words of the file; a rational is two.
struct Field {
    std::uint16_t type;
    std::uint32_t count;
    int word_size;
    std::vector<std::uint64_t> words;
};

/// A directory and those that it points to.
struct Ifd {
    std::map<int, Field> fields;
    std::vector<Ifd> sub_ifds; ///< SubIFDs (330)
    std::vector<Ifd> exif; ///< ExifIFD (34665): none or one

    Ifd& bytes(int tag, const std::vector<std::uint64_t>& values);
    Ifd& shorts(int tag, const std::vector<std::uint64_t>& values);
    Ifd& longs(int tag, const std::vector<std::uint64_t>& values);
    Ifd& text(int tag, const std::string& value); ///< as it is: no NUL is added
    /// Numerators over one denominator.
    Ifd& rationals(int tag, const std::vector<std::int64_t>& numerators,
                   std::int64_t denominator);
    /// Numerator and denominator, as pairs.
    Ifd& fractions(int tag,
                   const std::vector<std::pair<std::uint64_t, std::uint64_t>>& values);
    Ifd& signed_rationals(int tag, const std::vector<std::int64_t>& numerators,
                          std::int64_t denominator);
    Ifd& doubles(int tag, const std::vector<double>& values);
    Ifd& without(int tag);
};

/// The file whose first directory is @p ifd0; as a BigTIFF, @p is_big_tiff.
std::string file_of(const Ifd& ifd0, bool big_endian = false, bool is_big_tiff = false);

/// What a raw IFD needs: 8 x 6 pixels, RGGB, black 64, white 1023.
Ifd raw_tags();
/// What IFD0 needs besides: names, one matrix for D65, a neutral. No Exif.
Ifd camera_tags();
/// Both in IFD0.
Ifd tiny_dng();
/// camera_tags() of a preview, the raw in a SubIFD behind another one, and an Exif IFD.
Ifd tiny_dng_with_sub_ifds();

} // namespace cg2raw::test

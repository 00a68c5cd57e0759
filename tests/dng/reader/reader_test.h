// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What tests of the DNG reader do with the files that they build.
#pragma once

#include "reader/metadata_parts.h"
#include "tiff_builder.h"

#include <sstream>

namespace cg2raw::test {

/// What the reader makes of the file whose first directory is @p ifd0.
inline DngMetadata read(const Ifd& ifd0, bool big_endian = false,
                        bool is_big_tiff = false)
{
    std::istringstream stream(file_of(ifd0, big_endian, is_big_tiff));
    return read_dng_stream(stream, "test.dng");
}

/// Whether one of the notes holds these words.
inline bool has_note(const std::vector<std::string>& notes, const std::string& words)
{
    for (const std::string& note : notes)
        if (note.find(words) != std::string::npos)
            return true;
    return false;
}

} // namespace cg2raw::test

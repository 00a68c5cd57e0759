// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What libtiff asks of its client: bytes in and out, complaints, and tags by
/// type.
#pragma once

#include "tiff/atomic_file.h"
#include "tiff/tag_values.h"

#include <array>

struct tiff;

namespace cg2raw {

/// The file as libtiff sees it, where it stands, and its first complaint.
struct TiffClient {
    explicit TiffClient(AtomicFile& atomic_file)
        : file(atomic_file)
    {
    }

    AtomicFile& file;
    std::uint64_t position = 0;
    std::array<char, 512> complaint {}; ///< text; of what needs no memory
};

/// A classic TIFF in the machine's byte order, over @p client; null: see its complaint.
tiff* open_tiff(TiffClient& client);

/// Frees what libtiff holds. Nothing more is written: what the file lacks then was not
/// to be in it, or writing it has failed.
void close_tiff(tiff* tif);

/// Sets a tag as its value's type asks; declares it first for this file if libtiff does
/// not know it. False: see the client's complaint.
bool set_tag(tiff* tif, const Tag& tag);

} // namespace cg2raw

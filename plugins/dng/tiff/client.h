// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What libtiff asks of its client: bytes in and out, complaints, and tags by
/// type.
#pragma once

#include "tiff/atomic_file.h"
#include "tiff/tag_values.h"

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
    std::string complaint;
};

/// A classic TIFF in the machine's byte order, over @p client; null: see its complaint.
tiff* open_tiff(TiffClient& client);

/// Sets a tag as its value's type asks; declares it first for this file if libtiff does
/// not know it. False: see the client's complaint.
bool set_tag(tiff* tif, const Tag& tag);

} // namespace cg2raw

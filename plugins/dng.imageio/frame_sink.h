// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Where the pixels of one file go: blocks in any order -> simulation -> DNG.
#pragma once

#include "cg2raw/export.h"
#include "host_pixels.h"

#include <memory>

namespace cg2raw {

/// A file that is being written. It appears under its name when finish() succeeds;
/// without that, nothing is left of it.
class FrameSink {
public:
    virtual ~FrameSink() = default;
    /// A block whose first pixel is @p at. Throws Error for pixels outside the frame,
    /// and for pixels that were there already.
    virtual void put(const HostPixels& block, Site at) = 0;
    /// After the last block. Throws Error if a row is missing.
    virtual void finish() = 0;

    /// Pixels so far that were not finite.
    const Illegal& illegal() const { return m_illegal; }

protected:
    Illegal m_illegal;
};

/// The file @p name of an export. Pixels stream through it, row by row, unless
/// an effect needs more of the frame than its pixel: they are held until finish() then.
std::unique_ptr<FrameSink> frame_sink(const std::string& name, const Export& decided,
                                      Size frame);

} // namespace cg2raw

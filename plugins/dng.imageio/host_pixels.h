// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Pixels as a host hands them over -> views of float RGB.
#pragma once

#include "cg2raw/encoding.h"
#include "cg2raw/spectral_image.h"
#include "cg2raw/types.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <vector>

namespace cg2raw {

/// A block of pixels in the host's memory, in its format.
struct HostPixels {
    const char* data;
    OIIO::TypeDesc format;
    int width, height;
    OIIO::stride_t xstride, ystride; ///< bytes
    std::array<int, 3> channels; ///< of red, green and blue
    int nchannels; ///< of a pixel
    const SpectralResponse* spectral = nullptr; ///< if the channels are a spectrum
    const Decoder* decoder = nullptr; ///< of numbers that are not light
    int alpha = -1; ///< its channel, for the decoder

    /// Rows @p first ... first + count - 1.
    HostPixels rows(int first, int count) const;
};

/// A view of host pixels as light in float RGB, camera RGB if they are spectra; @p room
/// holds them when they must be converted.
RgbView rgb_view(const HostPixels& host, std::vector<float>& room);

/// Where the pixels of an image lie in the frame that is written: its display window.
/// Pixels of the data window outside it are cut off; what it has beyond the data window
/// is black, as where oiiotool writes a format that has no windows.
class FrameWindow {
public:
    /// Throws Error if the two windows have no pixel in common, or the image none.
    explicit FrameWindow(const OIIO::ImageSpec& spec);

    Size size() const { return m_size; }
    /// The part of a block of the data window, whose first pixel is @p at, that lies in
    /// the frame; @p at becomes its place there. False if none does.
    bool take(HostPixels& host, Site& at) const;
    /// Calls @p visit with blocks of black that, with the data window, are the frame.
    template <class Visit> void each_margin(const Visit& visit) const
    {
        const int top = std::max(m_data.row, 0);
        const auto [bottom, right] = m_data_end;
        visit(black({ m_size.width, top }), Site { 0, 0 });
        visit(black({ m_data.col, bottom - top }), Site { top, 0 });
        visit(black({ m_size.width - right, bottom - top }), Site { top, right });
        visit(black({ m_size.width, m_size.height - bottom }), Site { bottom, 0 });
    }

private:
    static HostPixels black(Size size);

    Size m_size;
    /// Of the data window's first pixel in the frame, and behind its last there.
    Site m_data {}, m_data_end {};
};

} // namespace cg2raw

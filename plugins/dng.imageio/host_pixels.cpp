// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "host_pixels.h"

#include <algorithm>
#include <cstdint>
#include <string>

namespace cg2raw {
namespace {

using OIIO::stride_t;
using OIIO::TypeDesc;

bool are_together(const std::array<int, 3>& channels)
{
    return channels[1] == channels[0] + 1 && channels[2] == channels[0] + 2;
}

/// Whether float RGB can be seen where it lies.
bool is_in_place(const HostPixels& host)
{
    return !host.decoder && host.format == TypeDesc::FLOAT
        && are_together(host.channels) && host.xstride % stride_t(sizeof(float)) == 0
        && host.ystride % stride_t(sizeof(float)) == 0;
}

std::string text_of(int x, int y, int width, int height)
{
    return std::to_string(width) + "x" + std::to_string(height) + " at "
        + std::to_string(x) + "," + std::to_string(y);
}

/// Camera RGB of spectra, in @p room; a row at a time is converted to float.
RgbView spectral_view(const HostPixels& host, std::vector<float>& room)
{
    const std::size_t width = std::size_t(host.width);
    const bool in_place
        = host.format == TypeDesc::FLOAT && host.xstride % stride_t(sizeof(float)) == 0;
    room.resize(3 * width * std::size_t(host.height));
    std::vector<float> row(in_place ? 0 : width * std::size_t(host.nchannels));
    for (int y = 0; y < host.height; ++y) {
        const char* const data = host.data + y * host.ystride;
        if (!in_place)
            OIIO::convert_image(host.nchannels, host.width, 1, 1, data, host.format,
                                host.xstride, OIIO::AutoStride, OIIO::AutoStride,
                                row.data(), TypeDesc::FLOAT, OIIO::AutoStride,
                                OIIO::AutoStride, OIIO::AutoStride);
        host.spectral->to_camera(
            in_place ? reinterpret_cast<const float*>(data) : row.data(),
            in_place ? host.xstride / stride_t(sizeof(float)) : host.nchannels,
            host.width, room.data() + 3 * width * std::size_t(y));
    }
    return { room.data(), host.width, host.height, 3, 3 * std::ptrdiff_t(host.width) };
}

/// Where a channel of the first pixel lies.
const char* channel_of(const HostPixels& host, int channel)
{
    return host.data + channel * stride_t(host.format.size());
}

/// The numbers in @p room become light, a row at a time.
void decode(const HostPixels& host, std::vector<float>& room)
{
    const std::size_t width = std::size_t(host.width);
    std::vector<float> alpha(host.decoder->needs_alpha() ? width : 0);
    for (int y = 0; y < host.height; ++y) {
        if (!alpha.empty())
            OIIO::convert_image(
                1, host.width, 1, 1, channel_of(host, host.alpha) + y * host.ystride,
                host.format, host.xstride, host.ystride, OIIO::AutoStride, alpha.data(),
                TypeDesc::FLOAT, sizeof(float), OIIO::AutoStride, OIIO::AutoStride);
        host.decoder->decode(room.data() + 3 * width * std::size_t(y), alpha.data(), 1,
                             host.width);
    }
}

} // namespace

HostPixels HostPixels::rows(int first, int count) const
{
    HostPixels part = *this;
    part.data += first * ystride;
    part.height = count;
    return part;
}

RgbView rgb_view(const HostPixels& host, std::vector<float>& room)
{
    if (host.spectral)
        return spectral_view(host, room);
    const auto channel = [&](int color) {
        return channel_of(host, host.channels[std::size_t(color)]);
    };
    if (is_in_place(host))
        return { reinterpret_cast<const float*>(channel(0)), host.width, host.height,
                 host.xstride / stride_t(sizeof(float)),
                 host.ystride / stride_t(sizeof(float)) };
    room.resize(3 * std::size_t(host.width) * std::size_t(host.height));
    constexpr stride_t pixel = 3 * sizeof(float);
    const int at_once = are_together(host.channels) ? 3 : 1;
    for (int color = 0; color < 3; color += at_once)
        OIIO::convert_image(at_once, host.width, host.height, 1, channel(color),
                            host.format, host.xstride, host.ystride, OIIO::AutoStride,
                            room.data() + color, TypeDesc::FLOAT, pixel,
                            pixel * host.width, OIIO::AutoStride);
    if (host.decoder)
        decode(host, room);
    return { room.data(), host.width, host.height, 3, 3 * std::ptrdiff_t(host.width) };
}

FrameWindow::FrameWindow(const OIIO::ImageSpec& spec)
    : m_size { spec.full_width, spec.full_height }
{
    const Size data { spec.width, spec.height };
    if (data.width <= 0 || data.height <= 0)
        throw Error("its data window has " + std::to_string(data.width) + " x "
                    + std::to_string(data.height) + " pixels: it is no picture");
    // Files state any integer, and a difference of two may be none.
    std::int64_t row = std::int64_t(spec.y) - spec.full_y;
    std::int64_t col = std::int64_t(spec.x) - spec.full_x;
    if (spec.full_width <= 0 || spec.full_height <= 0) { // a host that knows of none
        m_size = data;
        row = col = 0;
    }
    if (row >= m_size.height || row + data.height <= 0 || col >= m_size.width
        || col + data.width <= 0)
        throw Error(
            "its data window, " + text_of(spec.x, spec.y, spec.width, spec.height)
            + ", lies outside its display window, "
            + text_of(spec.full_x, spec.full_y, spec.full_width, spec.full_height)
            + ": nothing would be seen (oiiotool --origin, or --fullpixels)");
    m_data = { int(row), int(col) };
    m_data_end = { int(std::min<std::int64_t>(row + data.height, m_size.height)),
                   int(std::min<std::int64_t>(col + data.width, m_size.width)) };
}

bool FrameWindow::take(HostPixels& host, Site& at) const
{
    const std::int64_t row = std::int64_t(at.row) + m_data.row;
    const std::int64_t col = std::int64_t(at.col) + m_data.col;
    const auto first
        = [](std::int64_t place) { return std::max<std::int64_t>(place, 0); };
    const std::int64_t bottom
        = std::min<std::int64_t>(row + host.height, m_size.height);
    const std::int64_t right = std::min<std::int64_t>(col + host.width, m_size.width);
    if (bottom <= first(row) || right <= first(col))
        return false;
    host.data += (first(row) - row) * host.ystride + (first(col) - col) * host.xstride;
    host.height = int(bottom - first(row));
    host.width = int(right - first(col));
    at = { int(first(row)), int(first(col)) };
    return true;
}

HostPixels FrameWindow::black(Size size)
{
    static constexpr float pixel[3] {};
    return { reinterpret_cast<const char*>(pixel),
             TypeDesc::FLOAT,
             size.width,
             size.height,
             0,
             0,
             { 0, 1, 2 },
             3 };
}

} // namespace cg2raw

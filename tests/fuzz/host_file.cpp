// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "host_file.h"

#include "cg2raw/dng_mosaic.h"
#include "targets.h"

#include <algorithm>
#include <cstdint>
#include <fstream>

using namespace OIIO;

OIIO_PLUGIN_NAMESPACE_BEGIN
extern "C" ImageOutput* dng_output_imageio_create();
OIIO_PLUGIN_NAMESPACE_END

namespace cg2raw::test {
namespace {

constexpr std::int64_t most_pixels = 1 << 15, most_bytes = 1 << 22;
constexpr int largest_side = 65535;

/// Whether an image takes time and memory by its size alone.
bool is_large(const ImageSpec& spec)
{
    const bool has_window = spec.full_width > 0 && spec.full_height > 0;
    const int width = has_window ? spec.full_width : spec.width;
    const int height = has_window ? spec.full_height : spec.height;
    return width > 0 && width <= largest_side && height > 0 && height <= largest_side
        && std::int64_t(width) * height > most_pixels;
}

/// Whether a host could have made it. Of a tile OpenImageIO's write_image() makes one
/// whole, whatever part of it the image fills.
bool is_possible(const ImageSpec& spec)
{
    const std::int64_t tile = std::int64_t(spec.tile_width) * spec.tile_height;
    return spec.width > 0 && spec.height > 0 && spec.nchannels > 0
        && std::int64_t(spec.width) * spec.nchannels <= most_bytes
        && tile * spec.nchannels <= most_bytes;
}

} // namespace

HostFile::HostFile(const ScratchFolder& folder)
    : m_folder(folder)
{
}

HostFile::~HostFile() = default;

void HostFile::open(const std::string& name, const ImageSpec& spec,
                    ImageOutput::OpenMode mode)
{
    if (is_large(spec))
        return;
    if (!m_output)
        m_output.reset(dng_output_imageio_create());
    m_name = (m_folder.path() / name).string();
    m_spec = spec;
    m_has_failed = false;
    m_is_open = m_output->open(m_name, spec, mode);
    expect(m_is_open, true);
    check_folder();
}

void HostFile::write_rows(int first, int end, TypeDesc format)
{
    const std::int64_t rows = std::int64_t(end) - first;
    const std::int64_t width = m_spec.width;
    if (!m_is_open || !is_possible(m_spec) || rows > most_bytes / width)
        return;
    const char* const pixels
        = data(std::size_t(std::max<std::int64_t>(rows, 0) * width), format);
    if (pixels)
        expect(m_output->write_scanlines(first, end, 0, format, pixels,
                                         pixel_size(format), AutoStride),
               true);
}

void HostFile::write_tile(int x, int y, TypeDesc format)
{
    const std::int64_t width = m_spec.tile_width, height = m_spec.tile_height;
    if (!m_is_open || !is_possible(m_spec) || width <= 0 || height <= 0)
        return;
    if (const char* const pixels = data(std::size_t(width * height), format))
        expect(m_output->write_tile(x, y, 0, format, pixels, pixel_size(format),
                                    AutoStride, AutoStride),
               true);
}

void HostFile::write_image(TypeDesc format)
{
    const std::int64_t pixels = std::int64_t(m_spec.width) * m_spec.height;
    if (!m_is_open || !is_possible(m_spec) || pixels > most_pixels)
        return;
    if (const char* const all = data(std::size_t(pixels), format))
        expect(m_output->write_image(format, all, pixel_size(format)), false);
}

void HostFile::close()
{
    if (!m_output)
        return;
    const bool had_failed = m_has_failed;
    const bool done = m_output->close();
    expect(done, true);
    if (done && m_is_open && !had_failed)
        m_published.insert(std::filesystem::path(m_name).filename().string());
    m_is_open = false;
    check_folder();
}

void HostFile::drop()
{
    m_output.reset();
    m_is_open = false;
    check_folder();
}

void HostFile::pad(int bytes) { m_pad = std::clamp(bytes, 0, 64); }

stride_t HostFile::pixel_size(TypeDesc format) const
{
    const TypeDesc given = format == TypeDesc::UNKNOWN ? TypeDesc::UINT16 : format;
    return stride_t(given.size()) * m_spec.nchannels + m_pad;
}

/// Numbers of which some are not finite, in a format that has such; none if they would
/// be too many, or the format is none of pixels.
const char* HostFile::data(std::size_t pixels, TypeDesc format)
{
    const bool is_format = format == TypeDesc(TypeDesc::BASETYPE(format.basetype))
        && format.basetype != TypeDesc::NONE && format.basetype != TypeDesc::STRING
        && format.basetype != TypeDesc::PTR;
    const std::size_t size = pixels * std::size_t(pixel_size(format));
    if (!is_format || size > std::size_t(most_bytes))
        return nullptr;
    m_data.resize(std::max<std::size_t>(size, 1));
    std::uint32_t state = std::uint32_t(pixels);
    for (char& byte : m_data) {
        state = state * 1664525U + 1013904223U;
        byte = char(state >> 28 == 0 ? 0xff : state >> 24);
    }
    return m_data.data();
}

/// @p is_ours : the call is answered by the plugin alone.
void HostFile::expect(bool done, bool is_ours)
{
    const std::string message = m_output->geterror();
    if (done || m_has_failed)
        return;
    m_has_failed = true;
    if (message.empty())
        throw Finding("a call fails without a message");
    if (!is_ours)
        return;
    check_message(message);
    if (message.find(Error(m_name).what()) == message.npos
        && message.size() < Error::longest_message)
        throw Finding("a message does not name " + m_name + ": " + message);
}

void HostFile::check_folder() const
{
    const auto names = m_folder.names();
    if (names != std::vector<std::string>(m_published.begin(), m_published.end()))
        throw Finding("the folder holds " + std::to_string(names.size())
                      + " files, and " + std::to_string(m_published.size())
                      + " were published");
    if (!m_is_open
        && m_published.count(std::filesystem::path(m_name).filename().string()) > 0)
        check_file();
}

/// The file reads back, all of it.
void HostFile::check_file() const
{
    std::ifstream file(m_name, std::ios::binary);
    DngMosaic mosaic(file, m_name);
    const Size size = mosaic.storage().size;
    std::vector<std::uint16_t> dn(std::size_t(size.width) * std::size_t(size.height));
    mosaic.read_rows(0, { dn.data(), size.width, size.height, size.width });
}

} // namespace cg2raw::test

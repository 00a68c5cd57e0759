// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The other face of cg2raw in OpenImageIO: DNG -> mosaic, or a linear picture.
#include "cg2raw/dng_mosaic.h"
#include "failure.h"
#include "proxy_stream.h"
#include "read_attributes.h"
#include "thread_pool.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <new>

using namespace OIIO;

namespace cg2raw {

/// One DNG, one subimage: its RAW. A DNG that cannot be read opens, as one pixel, and
/// tells why when that is read: of a file that does not open, OpenImageIO would let its
/// TIFF reader show the preview.
class DngInput final : public ImageInput {
public:
    ~DngInput() override { forget(); }

    static void* operator new(std::size_t size);
    static void operator delete(void* memory) noexcept;

    const char* format_name() const override { return "dng"; }
    int supports(string_view feature) const override
    {
        return feature == "ioproxy" || feature == "exif";
    }
    bool valid_file(const std::string& name) const override;
#if OIIO_VERSION >= 20500
    bool valid_file(Filesystem::IOProxy* bytes) const override;
#endif

    bool open(const std::string& name, ImageSpec& spec) override
    {
        return open(name, spec, ImageSpec());
    }
    bool open(const std::string& name, ImageSpec& spec,
              const ImageSpec& config) override;
    bool close() override;

    using ImageInput::read_native_scanlines;
    bool read_native_scanline(int subimage, int miplevel, int y, int z,
                              void* data) override;
    bool read_native_scanlines(int subimage, int miplevel, int ybegin, int yend, int z,
                               void* data) override;

private:
    void start_or_keep_why_not(const ImageSpec& config);
    void tell_error() noexcept;
    void start(const std::string& name, const ImageSpec& config);
    void start_mosaic();
    void start_picture();
    void read(int first, int count, void* data);
    void forget();

    std::string m_name;
    std::unique_ptr<ProxyStream> m_stream;
    std::unique_ptr<DngMosaic> m_mosaic;
    std::unique_ptr<DevelopedDng> m_picture; ///< none: the mosaic is asked for
    std::string m_unreadable; ///< why; empty: it is readable
    std::mutex m_guard; ///< hosts may read one file from several threads
};

namespace {

/// The one reader for which there is always memory: OpenImageIO 2.4 takes one of each
/// plugin to see what it can do, and does not see when it gets none.
alignas(DngInput) std::array<char, sizeof(DngInput)> reserve;
std::atomic<bool> reserve_is_used { false };

} // namespace

void* DngInput::operator new(std::size_t size)
{
    if (void* const memory = ::operator new(size, std::nothrow))
        return memory;
    if (reserve_is_used.exchange(true))
        throw std::bad_alloc();
    return reserve.data();
}

void DngInput::operator delete(void* memory) noexcept
{
    if (memory == reserve.data())
        reserve_is_used = false;
    else
        ::operator delete(memory);
}

bool DngInput::valid_file(const std::string& name) const
try {
    Filesystem::IOFile file(name, Filesystem::IOProxy::Read);
    if (!file.opened())
        return false;
    ProxyStream stream(file);
    return is_dng(stream);
} catch (...) { // no memory to find out
    return false;
}

#if OIIO_VERSION >= 20500
bool DngInput::valid_file(Filesystem::IOProxy* bytes) const
try {
    if (!bytes || bytes->mode() != Filesystem::IOProxy::Read)
        return false;
    ProxyStream stream(*bytes);
    return is_dng(stream);
} catch (...) {
    return false;
}
#endif

bool DngInput::open(const std::string& name, ImageSpec& spec, const ImageSpec& config)
{
    const std::lock_guard<std::mutex> lock(m_guard);
    if (m_stream) // else the proxy is the one that the host has just set
        forget();
    try {
        m_name = name;
        ioproxy_retrieve_from_config(config);
        if (!ioproxy_use_or_open(name))
            return false;
        m_stream = std::make_unique<ProxyStream>(*ioproxy());
        start_or_keep_why_not(config);
        spec = m_spec;
        return true;
    } catch (...) {
        tell_error();
        forget();
        return false;
    }
}

/// Throws what is wrong with a file that is no DNG: another reader may know what it is.
void DngInput::start_or_keep_why_not(const ImageSpec& config)
{
    try {
        start(m_name, config);
    } catch (...) {
        if (!is_dng(*m_stream))
            throw;
        tell_failure(m_name, ImageSpec(),
                     [this](const std::string& why) { m_unreadable = why; });
        if (m_unreadable.empty())
            throw;
        m_spec = ImageSpec(1, 1, 1, TypeDesc::UINT16);
        m_spec.attribute("raw:Unreadable", m_unreadable);
    }
}

/// Of the exception that is being handled.
void DngInput::tell_error() noexcept
{
    tell_failure(m_name, m_spec,
                 [this](const std::string& message) { errorfmt("{}", message); });
}

void DngInput::start(const std::string& name, const ImageSpec& config)
{
    const bool developed = wants_developed(config);
    m_mosaic = std::make_unique<DngMosaic>(*m_stream, name);
    if (developed)
        start_picture();
    else
        start_mosaic();
    add_attributes(m_mosaic->metadata(), m_mosaic->storage(), m_spec);
}

void DngInput::start_mosaic()
{
    const DngStorage& storage = m_mosaic->storage();
    const Size area = m_mosaic->metadata().active_area;
    const bool bytes = storage.bits == 8 && !storage.is_linearised;
    m_spec = ImageSpec(storage.size.width, storage.size.height, 1,
                       bytes ? TypeDesc::UINT8 : TypeDesc::UINT16);
    m_spec.channelnames = { "Y" };
    m_spec.full_x = storage.active_area.col;
    m_spec.full_y = storage.active_area.row;
    m_spec.full_width = area.width;
    m_spec.full_height = area.height;
}

void DngInput::start_picture()
{
    m_picture = std::make_unique<DevelopedDng>(*m_mosaic);
    const Size size = m_picture->size();
    m_spec = ImageSpec(size.width, size.height, 3, TypeDesc::FLOAT);
    // What this OpenImageIO calls it when it reads OpenEXR.
    m_spec.attribute("oiio:ColorSpace",
                     OIIO_VERSION < 30000       ? "Linear"
                         : OIIO_VERSION < 30100 ? "lin_rec709"
                                                : "lin_rec709_scene");
}

bool DngInput::read_native_scanline(int subimage, int miplevel, int y, int z,
                                    void* data)
{
    return read_native_scanlines(subimage, miplevel, y, y + 1, z, data);
}

bool DngInput::read_native_scanlines(int subimage, int miplevel, int ybegin, int yend,
                                     int, void* data)
{
    const std::lock_guard<std::mutex> lock(m_guard);
    if (subimage != 0 || miplevel != 0) {
        errorfmt("{}: a DNG has one subimage, its RAW; there is no subimage {}, level "
                 "{}",
                 m_name, subimage, miplevel);
        return false;
    }
    try {
        if (!m_unreadable.empty())
            throw Error(m_unreadable);
        if (!m_mosaic)
            throw Error(m_name + ": is not open");
        read(ybegin, std::min(yend, m_spec.height) - ybegin, data);
        return true;
    } catch (...) {
        tell_error();
    }
    return false;
}

void DngInput::read(int first, int count, void* data)
{
    const std::ptrdiff_t width = m_spec.width;
    if (m_picture) {
        m_picture->read_rows(first, count, static_cast<float*>(data), 3 * width,
                             in_thread_pool);
        return;
    }
    const auto read_words = [&](std::uint16_t* words) {
        m_mosaic->read_rows(first, { words, m_spec.width, count, width },
                            in_thread_pool);
    };
    if (m_spec.format == TypeDesc::UINT16) {
        read_words(static_cast<std::uint16_t*>(data));
        return;
    }
    std::vector<std::uint16_t> words(std::size_t(width) * std::size_t(count));
    read_words(words.data());
    std::transform(words.begin(), words.end(), static_cast<std::uint8_t*>(data),
                   [](std::uint16_t word) { return std::uint8_t(word); });
}

bool DngInput::close()
{
    const std::lock_guard<std::mutex> lock(m_guard);
    forget();
    return true;
}

/// The picture before the mosaic, the mosaic before the stream that it reads.
void DngInput::forget()
{
    m_picture.reset();
    m_mosaic.reset();
    m_stream.reset();
    m_unreadable.clear();
    ioproxy_clear();
}

} // namespace cg2raw

OIIO_PLUGIN_NAMESPACE_BEGIN
extern "C" {

OIIO_EXPORT ImageInput* dng_input_imageio_create()
try {
    return new cg2raw::DngInput;
} catch (...) { // what was thrown would end the host
    return nullptr;
}

/// Another reader of .dng, LibRaw's, keeps that ending: OpenImageIO asks it first. Ours
/// is then to be had by the name cg2raw: ImageInput::create("cg2raw").
OIIO_EXPORT const char* dng_input_extensions[] = { "dng", "cg2raw", nullptr };
}
OIIO_PLUGIN_NAMESPACE_END

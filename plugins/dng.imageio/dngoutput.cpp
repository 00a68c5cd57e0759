// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The face of cg2raw in OpenImageIO: ImageSpec attributes -> simulation -> DNG.
#include "failure.h"
#include "frame_sink.h"
#include "host_pixels.h"
#include "image_facts.h"

#include <OpenImageIO/imageio.h>

#include <mutex>

using namespace OIIO;

namespace cg2raw {

/// One file: everything is decided in open(), pixels go to a sink, close() publishes.
class DngOutput final : public ImageOutput {
public:
    ~DngOutput() override { abandon(); }

    const char* format_name() const override { return "dng"; }
    int supports(string_view feature) const override;

    using ImageOutput::open;
    using ImageOutput::write_scanline;
    using ImageOutput::write_scanlines;
    using ImageOutput::write_tile;

    bool open(const std::string& name, const ImageSpec& spec, OpenMode mode) override;
    bool close() override;
    bool write_scanline(int y, int z, TypeDesc format, const void* data,
                        stride_t xstride) override;
    bool write_scanlines(int ybegin, int yend, int z, TypeDesc format, const void* data,
                         stride_t xstride, stride_t ystride) override;
    bool write_tile(int x, int y, int z, TypeDesc format, const void* data,
                    stride_t xstride, stride_t ystride, stride_t zstride) override;

private:
    template <class Work> bool reported(const Work& work);
    template <class Work> bool written(const Work& work);
    void start(const std::string& name);
    void finish();
    void abandon();
    HostPixels host_pixels(const void* data, TypeDesc format, int width, int height,
                           stride_t xstride, stride_t ystride, int full_width) const;
    void take(HostPixels host, Site at);

    std::string m_name;
    SceneLayer m_layer; ///< the channels to take of the host's pixels
    Decoder m_decoder; ///< of their numbers
    std::optional<SpectralResponse> m_spectral; ///< of pixels that are spectra
    std::optional<FrameWindow> m_window;
    std::unique_ptr<FrameSink> m_sink; ///< of the file that is open
    std::mutex m_guard; ///< hosts may write one file from several threads
};

int DngOutput::supports(string_view feature) const
{
    return feature == "tiles" || feature == "alpha" || feature == "random_access"
        || feature == "exif"
        // Of more channels we say that they are too many; hosts else drop them.
        || feature == "nchannels";
}

/// Runs @p work; whatever it throws becomes OpenImageIO's error message, and no file.
template <class Work> bool DngOutput::reported(const Work& work)
{
    try {
        work();
        return true;
    } catch (...) {
        tell_failure(m_name, m_spec,
                     [this](const std::string& message) { errorfmt("{}", message); });
    }
    abandon();
    return false;
}

/// Runs @p work on the file that is open. Of threads that wait for each other, those
/// behind one that failed find no file: the failure was reported when it happened.
template <class Work> bool DngOutput::written(const Work& work)
{
    const std::lock_guard<std::mutex> lock(m_guard);
    return m_sink && reported(work);
}

bool DngOutput::open(const std::string& name, const ImageSpec& spec, OpenMode mode)
{
    const std::lock_guard<std::mutex> lock(m_guard);
    abandon();
    return reported([&] {
        m_name = name;
        m_spec = spec;
        if (mode != Create)
            throw Error(
                "a DNG of ours holds one image: write each subimage to its own file "
                "(oiiotool --subimage N, or -sisplit)");
        // OpenImageIO divides by both when it writes an image.
        const bool tiled = spec.tile_width != 0 || spec.tile_height != 0;
        if (tiled && (spec.tile_width <= 0 || spec.tile_height <= 0))
            throw Error("its tiles have " + std::to_string(spec.tile_width) + " x "
                        + std::to_string(spec.tile_height)
                        + " pixels: give both sides, or 0 and 0 for none");
        start(name);
    });
}

void DngOutput::start(const std::string& name)
{
    const Export decided = resolve(image_facts(m_spec, name), attribute_options(m_spec),
                                   attribute_dialect());
    m_layer = decided.layer;
    m_decoder = decided.decoder;
    m_spectral = decided.spectral;
    m_window.emplace(m_spec);
    m_sink = frame_sink(name, decided, m_window->size());
    m_spec.format = TypeDesc::UINT16;
    m_window->each_margin([&](const HostPixels& black, Site at) {
        if (black.width > 0 && black.height > 0)
            m_sink->put(black, at);
    });
}

bool DngOutput::close()
{
    const std::lock_guard<std::mutex> lock(m_guard);
    if (!m_sink)
        return true; // nothing was opened, or it failed and said so
    return reported([&] { finish(); });
}

void DngOutput::finish()
{
    m_sink->finish();
    const auto [nan, inf] = m_sink->illegal();
    if (nan || inf)
        OIIO::debug("dng: " + m_name + ": " + std::to_string(nan)
                    + " NaN values became 0, " + std::to_string(inf)
                    + " infinite ones black or white\n");
    abandon();
}

void DngOutput::abandon() { m_sink.reset(); }

HostPixels DngOutput::host_pixels(const void* data, TypeDesc format, int width,
                                  int height, stride_t xstride, stride_t ystride,
                                  int full_width) const
{
    if (format == TypeDesc::UNKNOWN)
        format = m_spec.format;
    if (xstride == AutoStride)
        xstride = stride_t(format.size()) * m_spec.nchannels;
    if (ystride == AutoStride)
        ystride = xstride * full_width;
    return { static_cast<const char*>(data),
             format,
             width,
             height,
             xstride,
             ystride,
             m_layer.channels,
             m_spec.nchannels,
             m_spectral ? &*m_spectral : nullptr,
             m_decoder.is_identity() ? nullptr : &m_decoder,
             m_layer.alpha };
}

/// Pixels of the data window.
void DngOutput::take(HostPixels host, Site at)
{
    if (m_window->take(host, at))
        m_sink->put(host, at);
}

bool DngOutput::write_scanline(int y, int z, TypeDesc format, const void* data,
                               stride_t xstride)
{
    return write_scanlines(y, y + 1, z, format, data, xstride, AutoStride);
}

bool DngOutput::write_scanlines(int ybegin, int yend, int, TypeDesc format,
                                const void* data, stride_t xstride, stride_t ystride)
{
    return written([&] {
        const std::int64_t row = std::int64_t(ybegin) - m_spec.y;
        const std::int64_t rows = std::int64_t(yend) - ybegin;
        if (row < 0 || row > m_spec.height || rows < 0)
            throw Error("rows " + std::to_string(ybegin) + " to " + std::to_string(yend)
                        + " are outside the image");
        const int height = int(std::min(rows, m_spec.height - row));
        take(host_pixels(data, format, m_spec.width, height, xstride, ystride,
                         m_spec.width),
             { int(row), 0 });
    });
}

bool DngOutput::write_tile(int x, int y, int, TypeDesc format, const void* data,
                           stride_t xstride, stride_t ystride, stride_t)
{
    return written([&] {
        const std::int64_t row = std::int64_t(y) - m_spec.y;
        const std::int64_t col = std::int64_t(x) - m_spec.x;
        if (row < 0 || col < 0 || row >= m_spec.height || col >= m_spec.width)
            throw Error("tile at x " + std::to_string(x) + ", y " + std::to_string(y)
                        + " is outside the image");
        const Site at { int(row), int(col) };
        const int width = std::min(m_spec.tile_width, m_spec.width - at.col);
        const int height = std::min(m_spec.tile_height, m_spec.height - at.row);
        take(host_pixels(data, format, width, height, xstride, ystride,
                         m_spec.tile_width),
             at);
    });
}

} // namespace cg2raw

OIIO_PLUGIN_NAMESPACE_BEGIN
extern "C" {

OIIO_EXPORT int dng_imageio_version = OIIO_PLUGIN_VERSION;

OIIO_EXPORT const char* dng_imageio_library_version()
{
    return "cg2raw " CG2RAW_VERSION;
}

OIIO_EXPORT ImageOutput* dng_output_imageio_create()
try {
    return new cg2raw::DngOutput;
} catch (...) { // what was thrown would end the host
    return nullptr;
}

OIIO_EXPORT const char* dng_output_extensions[] = { "dng", nullptr };
}
OIIO_PLUGIN_NAMESPACE_END

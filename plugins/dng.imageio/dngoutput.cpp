// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The face of cg2raw in OpenImageIO: ImageSpec attributes -> simulation -> DNG.
#include "cg2raw/camera_frame.h"

#include "host_pixels.h"
#include "request.h"
#include "row_assembly.h"

#include <OpenImageIO/imageio.h>
#include <OpenImageIO/parallel.h>

#include <mutex>

using namespace OIIO;

namespace cg2raw {
namespace {

/// Rows that one task of the thread pool works on, and rows whose DN are held at a
/// time: hosts may hand over a whole image at once.
constexpr int task_rows = 4, held_rows = 64;
/// Rows of a frame that was held whole, whose DN are made and written at a time.
constexpr int finished_rows = 256;

/// OpenImageIO's thread pool. It lets no exception through, so the first one is kept.
void parallel(int count, const std::function<void(int)>& task)
{
    std::exception_ptr first_error;
    std::mutex guard;
    parallel_for(int64_t(0), int64_t(count), [&](int64_t index) {
        try {
            task(int(index));
        } catch (...) {
            const std::lock_guard<std::mutex> lock(guard);
            if (!first_error)
                first_error = std::current_exception();
        }
    });
    if (first_error)
        std::rethrow_exception(first_error);
}

} // namespace

/// One file: everything is decided in open(), pixels stream through, close() publishes.
/// Where an effect needs more of the frame than its pixel, they are held until close().
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
    void start(const std::string& name);
    void finish();
    void abandon();
    HostPixels host_pixels(const void* data, TypeDesc format, int width, int height,
                           stride_t xstride, stride_t ystride, int full_width) const;
    template <class Work> void each_task(const HostPixels& host, const Work& work);
    void take(HostPixels host, Site at);
    void take_block(const HostPixels& host, Site at);
    void simulate_held(const HostPixels& host, Site at);
    void hold(const HostPixels& host, Site at);
    void simulate_frame();

    std::string m_name;
    std::array<int, 3> m_channels {}; ///< of red, green and blue in the host's pixels
    std::optional<FrameWindow> m_window;
    std::unique_ptr<Simulation> m_simulation;
    std::unique_ptr<DngWriter> m_writer;
    /// Streamed: rows on their way to the writer. Held: what is there of the frame that
    /// some effect needs whole.
    std::unique_ptr<RowAssembly> m_rows;
    std::unique_ptr<CameraFrame> m_frame;
    std::unique_ptr<RowCount> m_count;
    std::vector<std::uint16_t> m_block; ///< DN of the rows that are held
    Illegal m_illegal;
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
    const std::lock_guard<std::mutex> lock(m_guard);
    try {
        work();
        return true;
    } catch (const std::bad_alloc&) {
        errorfmt("{}: not enough memory for {} x {} pixels", m_name, m_spec.width,
                 m_spec.height);
    } catch (const std::exception& error) {
        const std::string message = error.what();
        const bool names_file = message.find(m_name) != message.npos;
        errorfmt("{}{}", names_file ? "" : m_name + ": ", message);
    } catch (...) {
        errorfmt("{}: unknown failure", m_name);
    }
    abandon();
    return false;
}

bool DngOutput::open(const std::string& name, const ImageSpec& spec, OpenMode mode)
{
    abandon();
    m_name = name;
    m_spec = spec;
    return reported([&] {
        if (mode != Create)
            throw Error(
                "a DNG of ours holds one image: write each subimage to its own file "
                "(oiiotool --subimage N, or -sisplit)");
        if (spec.deep || spec.depth > 1)
            throw Error("deep and volume images cannot become a DNG: flatten first "
                        "(oiiotool --flatten)");
        start(name);
    });
}

void DngOutput::start(const std::string& name)
{
    const Request request = request_of(m_spec, name);
    m_channels = request.layer.channels;
    m_window.emplace(m_spec);
    const Size frame = m_window->size();
    m_simulation = std::make_unique<Simulation>(request.profile, request.run, frame);
    const DngDescription description
        = describe(*m_simulation, request.options, request.shot);
    m_writer
        = std::make_unique<DngWriter>(name, description, request.options, parallel);
    if (m_simulation->needs_whole_frame()) {
        m_frame = std::make_unique<CameraFrame>(*m_simulation);
        m_count = std::make_unique<RowCount>(frame);
    } else {
        m_rows = std::make_unique<RowAssembly>(
            frame, [this](const Plane<const std::uint16_t>& rows) {
                m_writer->write_rows(rows);
            });
    }
    m_spec.format = TypeDesc::UINT16;
    m_window->each_margin([&](const HostPixels& black, Site at) {
        if (black.width > 0 && black.height > 0)
            take_block(black, at);
    });
}

bool DngOutput::close()
{
    if (!m_writer)
        return true; // nothing was opened, or it failed and said so
    return reported([&] { finish(); });
}

void DngOutput::finish()
{
    const int rows = m_frame ? m_count->complete() : m_rows->rows_done();
    if (rows != m_window->size().height)
        throw Error("row " + std::to_string(rows)
                    + " was never written; no file is left");
    if (m_frame)
        simulate_frame();
    m_writer->close();
    if (m_illegal.nan || m_illegal.inf)
        OIIO::debug("dng: " + m_name + ": " + std::to_string(m_illegal.nan)
                    + " NaN values became 0, " + std::to_string(m_illegal.inf)
                    + " infinite ones black or white\n");
    abandon();
}

void DngOutput::abandon()
{
    m_rows.reset();
    m_frame.reset();
    m_count.reset();
    m_writer.reset();
    m_simulation.reset();
    m_illegal = {};
}

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
             m_channels };
}

/// Calls work(scene, first row, illegal) for a few rows at a time, in parallel.
template <class Work>
void DngOutput::each_task(const HostPixels& host, const Work& work)
{
    const int tasks = (host.height + task_rows - 1) / task_rows;
    std::vector<Illegal> illegal(std::size_t(tasks), Illegal {});
    parallel(tasks, [&](int task) {
        const int first = task * task_rows;
        const HostPixels part
            = host.rows(first, std::min(task_rows, host.height - first));
        std::vector<float> room;
        work(rgb_view(part, room), first, illegal[std::size_t(task)]);
    });
    for (const Illegal& part : illegal)
        m_illegal += part;
}

/// Pixels of the data window.
void DngOutput::take(HostPixels host, Site at)
{
    if (m_window->take(host, at))
        take_block(host, at);
}

void DngOutput::take_block(const HostPixels& host, Site at)
{
    if (m_frame) {
        hold(host, at);
        return;
    }
    for (int first = 0; first < host.height; first += held_rows) {
        const int rows = std::min(held_rows, host.height - first);
        simulate_held(host.rows(first, rows), { at.row + first, at.col });
    }
}

void DngOutput::simulate_held(const HostPixels& host, Site at)
{
    m_block.resize(std::size_t(host.width) * std::size_t(host.height));
    each_task(host, [&](const RgbView& scene, int first, Illegal& illegal) {
        m_simulation->block(
            scene, { at.row + first, at.col },
            Plane<std::uint16_t> { m_block.data() + std::ptrdiff_t(first) * host.width,
                                   host.width, scene.height, host.width },
            illegal);
    });
    m_rows->put(at, { m_block.data(), host.width, host.height, host.width });
}

void DngOutput::hold(const HostPixels& host, Site at)
{
    m_count->add(at, { host.width, host.height });
    each_task(host, [&](const RgbView& scene, int first, Illegal& illegal) {
        m_frame->put(scene, { at.row + first, at.col }, illegal);
    });
}

void DngOutput::simulate_frame()
{
    const Size frame = m_window->size();
    m_frame->complete();
    for (int first = 0; first < frame.height; first += finished_rows) {
        const int rows = std::min(finished_rows, frame.height - first);
        m_block.resize(std::size_t(frame.width) * std::size_t(rows));
        m_frame->simulate(first, { m_block.data(), frame.width, rows, frame.width },
                          parallel);
        m_writer->write_rows({ m_block.data(), frame.width, rows, frame.width });
    }
}

bool DngOutput::write_scanline(int y, int z, TypeDesc format, const void* data,
                               stride_t xstride)
{
    return write_scanlines(y, y + 1, z, format, data, xstride, AutoStride);
}

bool DngOutput::write_scanlines(int ybegin, int yend, int, TypeDesc format,
                                const void* data, stride_t xstride, stride_t ystride)
{
    if (!m_writer)
        return false; // the failure was reported when it happened
    return reported([&] {
        take(host_pixels(data, format, m_spec.width, yend - ybegin, xstride, ystride,
                         m_spec.width),
             { ybegin - m_spec.y, 0 });
    });
}

bool DngOutput::write_tile(int x, int y, int, TypeDesc format, const void* data,
                           stride_t xstride, stride_t ystride, stride_t)
{
    if (!m_writer)
        return false;
    return reported([&] {
        const Site at { y - m_spec.y, x - m_spec.x };
        if (at.row < 0 || at.col < 0 || at.row >= m_spec.height
            || at.col >= m_spec.width)
            throw Error("tile at x " + std::to_string(x) + ", y " + std::to_string(y)
                        + " is outside the image");
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

OIIO_EXPORT ImageOutput* dng_output_imageio_create() { return new cg2raw::DngOutput; }

OIIO_EXPORT const char* dng_output_extensions[] = { "dng", nullptr };
}
OIIO_PLUGIN_NAMESPACE_END

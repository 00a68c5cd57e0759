// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "frame_sink.h"

#include "cg2raw/camera_frame.h"
#include "cg2raw/exposure.h"
#include "cg2raw/light_meter.h"
#include "row_assembly.h"
#include "thread_pool.h"

namespace cg2raw {
namespace {

/// Rows that one task of the thread pool works on, and rows whose DN are held at a
/// time: hosts may hand over a whole image at once.
constexpr int task_rows = 4, held_rows = 64;
/// Rows of a frame that was held whole, whose DN are made and written at a time.
constexpr int finished_rows = 256;

/// Calls work(scene, first row, illegal) for a few rows at a time, in parallel.
template <class Work>
void each_task(const HostPixels& host, Illegal& total, const Work& work)
{
    const int tasks = (host.height + task_rows - 1) / task_rows;
    std::vector<Illegal> illegal(std::size_t(tasks), Illegal {});
    in_thread_pool(tasks, [&](int task) {
        const int first = task * task_rows;
        const HostPixels part
            = host.rows(first, std::min(task_rows, host.height - first));
        std::vector<float> room;
        work(rgb_view(part, room), first, illegal[std::size_t(task)]);
    });
    for (const Illegal& part : illegal)
        total += part;
}

void check_complete(int rows, Size frame)
{
    if (rows != frame.height)
        throw Error("row " + std::to_string(rows)
                    + " was never written; no file is left");
}

/// Rows go to the writer as soon as all above them are there.
class StreamedFrame final : public FrameSink {
public:
    StreamedFrame(Simulation simulation, std::unique_ptr<DngWriter> writer)
        : m_simulation(std::move(simulation))
        , m_writer(std::move(writer))
        , m_rows(m_simulation.frame(), [this](const Plane<const std::uint16_t>& rows) {
            m_writer->write_rows(rows);
        })
    {
    }

    void put(const HostPixels& block, Site at) override
    {
        for (int first = 0; first < block.height; first += held_rows) {
            const int rows = std::min(held_rows, block.height - first);
            simulate(block.rows(first, rows), { at.row + first, at.col });
        }
    }

    void finish() override
    {
        check_complete(m_rows.rows_done(), m_simulation.frame());
        m_writer->close();
    }

private:
    void simulate(const HostPixels& host, Site at)
    {
        m_block.resize(std::size_t(host.width) * std::size_t(host.height));
        const Plane<std::uint16_t> raw { m_block.data(), host.width, host.height,
                                         host.width };
        each_task(host, m_illegal,
                  [&](const RgbView& scene, int first, Illegal& illegal) {
                      m_simulation.block(scene, { at.row + first, at.col },
                                         raw.rows(first, scene.height), illegal);
                  });
        m_rows.put(at, { m_block.data(), host.width, host.height, host.width });
    }

    Simulation m_simulation;
    std::unique_ptr<DngWriter> m_writer;
    RowAssembly m_rows;
    std::vector<std::uint16_t> m_block; ///< DN of the rows that are held
};

/// Camera RGB of the whole frame is held; its DN are made when all of it is there.
class HeldFrame final : public FrameSink {
public:
    HeldFrame(Simulation simulation, std::unique_ptr<DngWriter> writer)
        : m_simulation(std::move(simulation))
        , m_writer(std::move(writer))
        , m_camera(m_simulation)
        , m_count(m_simulation.frame())
    {
    }

    void put(const HostPixels& block, Site at) override
    {
        m_count.add(at, { block.width, block.height });
        each_task(block, m_illegal,
                  [&](const RgbView& scene, int first, Illegal& illegal) {
                      m_camera.put(scene, { at.row + first, at.col }, illegal);
                  });
    }

    void finish() override
    {
        const Size frame = m_simulation.frame();
        check_complete(m_count.complete(), frame);
        m_camera.complete();
        std::vector<std::uint16_t> dn;
        for (int first = 0; first < frame.height; first += finished_rows) {
            const int rows = std::min(finished_rows, frame.height - first);
            dn.resize(std::size_t(frame.width) * std::size_t(rows));
            m_camera.simulate(first, { dn.data(), frame.width, rows, frame.width },
                              in_thread_pool);
            m_writer->write_rows({ dn.data(), frame.width, rows, frame.width });
        }
        m_writer->close();
    }

private:
    Simulation m_simulation;
    std::unique_ptr<DngWriter> m_writer;
    CameraFrame m_camera;
    RowCount m_count;
};

/// Scene pixels of the whole frame are held; when all are there, their light is
/// metered, and they go to the sink of the exposure that was found.
class MeteredFrame final : public FrameSink {
public:
    MeteredFrame(std::string name, const Export& decided, Size frame)
        : m_name(std::move(name))
        , m_decided(decided)
        , m_frame(frame)
        , m_count(frame)
        , m_scene(std::size_t(frame.width) * std::size_t(frame.height) * 3)
    {
    }

    void put(const HostPixels& block, Site at) override
    {
        m_count.add(at, { block.width, block.height });
        Illegal none; // they are counted when they are simulated
        each_task(block, none, [&](const RgbView& scene, int first, Illegal&) {
            for (int row = 0; row < scene.height; ++row) {
                float* to = pixel(at.row + first + row, at.col);
                const float* from = scene.row(row);
                for (int col = 0; col < scene.width; ++col, to += 3)
                    std::copy_n(from + col * scene.pixel_stride, 3, to);
            }
        });
    }

    void finish() override
    {
        check_complete(m_count.complete(), m_frame);
        const auto rows = [this](int first, int count, std::vector<float>&) {
            return RgbView { pixel(first, 0), m_frame.width, count, 3,
                             std::ptrdiff_t(3) * m_frame.width };
        };
        m_decided.run
            = metered(m_decided.profile, m_decided.run, m_frame, rows, in_thread_pool);
        if (*m_decided.run.meter == 0.0)
            OIIO::debug("dng: " + m_name
                        + ": black: nothing to be metered, exposure 0\n");
        const auto sink = frame_sink(m_name, m_decided, m_frame);
        sink->put(whole_frame(), { 0, 0 });
        sink->finish();
        m_illegal = sink->illegal();
    }

private:
    float* pixel(int row, int col)
    {
        return m_scene.data()
            + (std::ptrdiff_t(row) * m_frame.width + col) * std::ptrdiff_t(3);
    }

    HostPixels whole_frame() const
    {
        const OIIO::stride_t pixel = 3 * sizeof(float);
        return { reinterpret_cast<const char*>(m_scene.data()),
                 OIIO::TypeDesc::FLOAT,
                 m_frame.width,
                 m_frame.height,
                 pixel,
                 pixel * m_frame.width,
                 { 0, 1, 2 },
                 3,
                 nullptr,
                 nullptr,
                 -1 };
    }

    std::string m_name;
    Export m_decided;
    Size m_frame;
    RowCount m_count;
    std::vector<float> m_scene; ///< R, G, B of each pixel
};

} // namespace

std::unique_ptr<FrameSink> frame_sink(const std::string& name, const Export& decided,
                                      Size frame)
{
    if (needs_meter(decided.run) && !decided.run.meter)
        return std::make_unique<MeteredFrame>(name, decided, frame);
    Simulation simulation(decided.profile, decided.run, frame);
    if (const std::string spectrum = simulation.spectrum(); !spectrum.empty())
        OIIO::debug("dng: " + name + ": the light's spectrum is that of " + spectrum
                    + "\n");
    auto writer = std::make_unique<DngWriter>(
        name, describe(simulation, decided.file, decided.shot), decided.file,
        in_thread_pool);
    if (simulation.needs_whole_frame())
        return std::make_unique<HeldFrame>(std::move(simulation), std::move(writer));
    return std::make_unique<StreamedFrame>(std::move(simulation), std::move(writer));
}

} // namespace cg2raw

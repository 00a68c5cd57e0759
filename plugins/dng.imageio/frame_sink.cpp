// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "frame_sink.h"

#include "cg2raw/camera_frame.h"
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

} // namespace

std::unique_ptr<FrameSink> frame_sink(const std::string& name, const Export& decided,
                                      Size frame)
{
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

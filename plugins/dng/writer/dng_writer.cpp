// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "cg2raw/dng_writer.h"

#include "tiff/file.h"
#include "writer/mosaic_store.h"
#include "writer/preview.h"
#include "writer/tags.h"

#include <cstdlib>
#include <new>

namespace cg2raw {

namespace {

constexpr std::uint16_t compression_none = 1;

Storage storage_of(const Preview& preview)
{
    const Size size = preview.size();
    Storage storage {
        std::uint32_t(size.width), std::uint32_t(size.height), 3, 8, photometric::rgb,
        compression_none
    };
    storage.rows_per_strip = storage.height;
    return storage;
}

void append(Tags& tags, const Tags& more)
{
    tags.insert(tags.end(), more.begin(), more.end());
}

const std::string& checked(const std::string& path, const DngDescription& description,
                           const DngOptions& options)
{
    check(description, path);
    // Known before a byte is written; compressed files find out as they grow.
    const std::uint64_t bytes = 2 * std::uint64_t(description.size.width)
        * std::uint64_t(description.size.height);
    if (options.compression == Compression::none && bytes > 0xfff00000)
        throw Error(
            path + ": " + std::to_string(bytes)
            + " bytes of pixels, but a TIFF file ends at 4 GiB: write a smaller "
              "image, or compress it");
    return path;
}

} // namespace

struct DngWriter::State {
    State(const std::string& path_, const DngDescription& description_,
          const DngOptions& options, ParallelFor parallel_)
        : path(checked(path_, description_, options))
        , size(description_.size)
        , store(mosaic_store(description_, options.compression, parallel_))
        , parallel(std::move(parallel_))
        , file(path, options.sync)
    {
        if (options.preview.value_or(!is_of_shot(description_.shot)))
            preview.emplace(description_);
    }

    void begin(const DngDescription& description, const DngOptions& options)
    {
        const std::uint64_t exif = file.write_exif(exif_tags(description.shot));
        Tags tags = camera_tags(description, options);
        append(tags, shot_tags(description.shot));
        if (preview) {
            append(tags, preview_tags());
            file.begin(storage_of(*preview), tags, exif, true);
            reserve_preview();
            file.begin_sub_ifd(store->storage(), mosaic_tags(description, options));
        } else {
            append(tags, mosaic_tags(description, options));
            file.begin(store->storage(), tags, exif, false);
        }
    }

    /// The picture is known only with the mosaic, its size now: its strip keeps the
    /// place.
    void reserve_preview()
    {
        const std::size_t bytes = 3 * std::size_t(preview->size().width)
            * std::size_t(preview->size().height);
        // Zeros that come fresh from the system take no memory until they are written
        // to.
        const std::unique_ptr<void, void (*)(void*)> blank(std::calloc(bytes, 1),
                                                           std::free);
        if (!blank)
            throw std::bad_alloc();
        file.write_chunk(0, blank.get(), bytes);
        preview_next = file.chunk_offset(0);
        file.end();
    }

    void add_to_preview(const Plane<const std::uint16_t>& mosaic_rows)
    {
        const std::vector<std::uint8_t>& pixels
            = preview->add_rows(mosaic_rows, parallel);
        if (pixels.empty())
            return;
        file.patch(preview_next, pixels.data(), pixels.size());
        preview_next += pixels.size();
    }

    std::string path;
    Size size;
    std::unique_ptr<MosaicStore> store;
    ParallelFor parallel;
    TiffFile file;
    std::optional<Preview> preview;
    std::uint64_t preview_next = 0; ///< place in the file of the picture's next row
    int rows = 0;
    bool closed = false;
};

DngWriter::DngWriter(const std::string& path, const DngDescription& description,
                     const DngOptions& options, ParallelFor parallel)
    : m_state(std::make_unique<State>(path, description, options, std::move(parallel)))
{
    m_state->begin(description, options);
}

DngWriter::~DngWriter() = default;

void DngWriter::write_rows(const Plane<const std::uint16_t>& rows)
{
    State& state = *m_state;
    if (rows.width != state.size.width || rows.height > state.size.height - state.rows)
        throw Error(state.path + ": rows of " + std::to_string(rows.width) + " pixels, "
                    + std::to_string(state.rows + rows.height)
                    + " in all, do not fit a " + std::to_string(state.size.width)
                    + " x " + std::to_string(state.size.height) + " mosaic");
    if (state.preview)
        state.add_to_preview(rows);
    state.store->write_rows(state.file, rows);
    state.rows += rows.height;
}

void DngWriter::close()
{
    State& state = *m_state;
    if (state.closed)
        return;
    if (state.rows != state.size.height)
        throw Error(state.path + ": " + std::to_string(state.rows) + " rows written of "
                    + std::to_string(state.size.height)
                    + ": write them all before closing");
    state.file.end();
    state.file.publish();
    state.closed = true;
}

void write_dng(const std::string& path, const Plane<const std::uint16_t>& raw,
               const DngDescription& description, const DngOptions& options,
               ParallelFor parallel)
{
    DngWriter writer(path, description, options, std::move(parallel));
    writer.write_rows(raw);
    writer.close();
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "writer/mosaic_store.h"

#include "jpeg/lossless.h"

#include <algorithm>
#include <mutex>

namespace cg2raw {

namespace {

constexpr std::uint16_t compression_none = 1;
constexpr std::uint16_t compression_jpeg = 7;
constexpr std::uint16_t stored_bits = 16;
/// TIFF 6 asks for tile sides in multiples of this.
constexpr int tile_step = 16;

int rounded_up(int value, int step) { return (value + step - 1) / step * step; }

/// What strips and tiles of a mosaic have in common. That of a monochrome sensor is
/// LinearRaw of one sample. Source: DNG specification 1.7.1, PhotometricInterpretation.
Storage storage_of(const DngDescription& description, std::uint16_t compression)
{
    const Size size = description.size;
    return { std::uint32_t(size.width),
             std::uint32_t(size.height),
             1,
             stored_bits,
             description.cfa.is_mono() ? photometric::linear_raw : photometric::cfa,
             compression };
}

/// Contiguous strips of about 1/2 MiB: dcraw reads on from the first strip, whatever
/// the others' offsets say; a single strip would be read whole into memory by libtiff's
/// users. A frame of a shot is one strip all the same, written in parts: DaVinci
/// Resolve takes no other uncompressed frame (dnglab, issue 368).
class Strips : public MosaicStore {
public:
    explicit Strips(const DngDescription& description)
        : m_size(description.size)
        , m_storage(storage_of(description, compression_none))
        , m_is_one(is_of_shot(description.shot))
        , m_groups(m_size, std::clamp(part_pixels / m_size.width, 1, m_size.height))
    {
        m_storage.rows_per_strip
            = std::uint32_t(m_is_one ? m_size.height : m_groups.rows_per_group());
    }

    Storage storage() const override { return m_storage; }

    void write_rows(TiffFile& file, const Plane<const std::uint16_t>& rows) override
    {
        m_groups.add(rows, [&](Plane<const std::uint16_t> strip) {
            if (strip.pitch != strip.width)
                strip = packed(strip);
            const std::size_t pixels
                = std::size_t(strip.width) * std::size_t(strip.height);
            file.write_chunk(m_next, strip.data, 2 * pixels);
            m_next += m_is_one ? 0 : 1;
        });
    }

private:
    static constexpr int part_pixels = 256 * 1024;

    Plane<const std::uint16_t> packed(const Plane<const std::uint16_t>& rows)
    {
        m_packed.clear();
        for (int row = 0; row < rows.height; ++row)
            m_packed.insert(m_packed.end(), rows.row(row), rows.row(row) + rows.width);
        return { m_packed.data(), rows.width, rows.height, rows.width };
    }

    Size m_size;
    Storage m_storage;
    bool m_is_one;
    RowGroups m_groups;
    std::vector<std::uint16_t> m_packed;
    std::uint32_t m_next = 0;
};

/// Rows of tiles of about 512 x 128: enough of them side by side for many threads, a
/// tile's pixels and codes within a core's cache, the code table under 0.1 % of a tile.
class Tiles : public MosaicStore {
public:
    Tiles(const DngDescription& description, Prediction prediction,
          ParallelFor parallel)
        : m_size(description.size)
        , m_prediction(prediction)
        , m_storage(storage_of(description, compression_jpeg))
        , m_repeat { description.cfa.width, description.cfa.height }
        , m_across(std::max(1, (m_size.width + widest / 2) / widest))
        , m_tile { 0, std::min(tile_height, rounded_up(m_size.height, tile_step)) }
        , m_groups(m_size, m_tile.height)
        , m_parallel(std::move(parallel))
    {
        // One tile may not be wider than the image (dcraw), hence two if that is no
        // multiple of 16.
        if (m_across == 1 && m_size.width % tile_step != 0)
            m_across = 2;
        m_tile.width = width_of(m_across);
        // LibRaw takes two lines of a JPEG that are just as wide as the image for one
        // of another layout and scrambles them (seen in 0.22).
        for (int rows = 1; rows <= (prediction == Prediction::best ? 2 : 1); ++rows)
            if (2 * rows * m_tile.width == m_size.width)
                m_tile.width = width_of(2 * rows + 1);
        m_across = (m_size.width + m_tile.width - 1) / m_tile.width;
        m_storage.tile_width = std::uint32_t(m_tile.width);
        m_storage.tile_height = std::uint32_t(m_tile.height);
        m_jpegs.resize(std::size_t(m_across));
        while ((description.white_level >> m_bits) != 0)
            ++m_bits;
    }

    /// Of one of @p across tiles side by side.
    int width_of(int across) const
    {
        return rounded_up((m_size.width + across - 1) / across, tile_step);
    }

    Storage storage() const override { return m_storage; }

    void write_rows(TiffFile& file, const Plane<const std::uint16_t>& rows) override
    {
        m_groups.add(rows, [&](const Plane<const std::uint16_t>& group) {
            m_parallel(m_across, [&](int i) { encode(group, i); });
            for (const std::vector<std::uint8_t>& jpeg : m_jpegs)
                file.write_chunk(m_next++, jpeg.data(), jpeg.size());
        });
    }

private:
    static constexpr int widest = 512;
    static constexpr int tile_height = 128;
    /// 8 bits or less would make some readers decode to bytes, against
    /// BitsPerSample 16.
    static constexpr int fewest_bits = 9;

    void encode(const Plane<const std::uint16_t>& group, int i)
    {
        const int left = i * m_tile.width;
        const Plane<const std::uint16_t> part {
            group.data + left, std::min(m_tile.width, m_size.width - left),
            group.height, group.pitch
        };
        std::unique_ptr<JpegScratch> scratch = taken_scratch();
        encode_lossless_jpeg(part, m_tile, m_repeat, m_bits, m_prediction, *scratch,
                             m_jpegs[std::size_t(i)]);
        const std::lock_guard<std::mutex> lock(m_guard);
        m_scratch.push_back(std::move(scratch));
    }

    /// One that no other thread uses: there are as many as threads, not as tiles.
    std::unique_ptr<JpegScratch> taken_scratch()
    {
        const std::lock_guard<std::mutex> lock(m_guard);
        if (m_scratch.empty())
            return std::make_unique<JpegScratch>();
        std::unique_ptr<JpegScratch> scratch = std::move(m_scratch.back());
        m_scratch.pop_back();
        return scratch;
    }

    Size m_size;
    Prediction m_prediction;
    Storage m_storage;
    Size m_repeat;
    int m_across; ///< tiles side by side
    Size m_tile;
    int m_bits = fewest_bits;
    RowGroups m_groups;
    ParallelFor m_parallel;
    std::mutex m_guard;
    std::vector<std::unique_ptr<JpegScratch>> m_scratch; ///< that no thread uses now
    std::vector<std::vector<std::uint8_t>> m_jpegs; ///< of one row of tiles
    std::uint32_t m_next = 0;
};

} // namespace

RowGroups::RowGroups(Size size, int rows_per_group)
    : m_size(size)
    , m_rows_per_group(rows_per_group)
{
}

void RowGroups::copy(const Plane<const std::uint16_t>& rows)
{
    const std::size_t width = std::size_t(m_size.width);
    m_copy.resize(width * std::size_t(m_rows_per_group));
    for (int row = 0; row < rows.height; ++row)
        std::copy_n(rows.row(row), width,
                    m_copy.data() + width * std::size_t(m_copied + row));
    m_copied += rows.height;
}

std::unique_ptr<MosaicStore> mosaic_store(const DngDescription& description,
                                          Compression compression, ParallelFor parallel)
{
    if (compression == Compression::none || description.size.width < tile_step)
        return std::make_unique<Strips>(description);
    const Prediction prediction
        = compression == Compression::ljpeg_2d ? Prediction::best : Prediction::left;
    return std::make_unique<Tiles>(description, prediction, std::move(parallel));
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "jpeg/lossless_decoder.h"

#include "jpeg/huffman_decoder.h"
#include "jpeg/predictor.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

namespace cg2raw {

namespace {

constexpr int most_components = 4;
/// Markers. Source: ITU-T T.81, table B.1.
enum Marker : int { sof0 = 0xc0, sof3 = 0xc3, dht = 0xc4, sof15 = 0xcf };
enum : int { soi = 0xd8, eoi = 0xd9, sos = 0xda, dri = 0xdd };

/// What SOF3 and SOS say.
struct Frame {
    int precision = 0;
    std::uint64_t lines = 0, columns = 0; ///< of samples of one component
    int components = 0;
    std::array<int, most_components> names {};
    std::array<int, most_components> tables {};
    int predictor = 0;
};

/// The bytes of one marker's segment, or of the whole file.
class Segment {
public:
    Segment(const std::uint8_t* begin, const std::uint8_t* end)
        : m_at(begin)
        , m_end(end)
    {
    }

    int byte()
    {
        if (m_at == m_end)
            throw Error("ends in its headers: it is truncated or damaged");
        return *m_at++;
    }
    int word()
    {
        const int high = byte();
        return high << 8 | byte();
    }
    const std::uint8_t* skip(std::size_t count)
    {
        if (count > left())
            throw Error("ends in its headers: it is truncated or damaged");
        return std::exchange(m_at, m_at + count);
    }
    std::size_t left() const { return std::size_t(m_end - m_at); }

private:
    const std::uint8_t *m_at, *m_end;
};

bool is_other_frame(int marker)
{
    constexpr int dac = 0xcc, jpg = 0xc8;
    return marker >= sof0 && marker <= sof15 && marker != dht && marker != dac
        && marker != jpg && marker != sof3;
}

/// All that precedes the samples.
class Headers {
public:
    explicit Headers(Segment bytes)
        : m_bytes(bytes)
    {
        if (m_bytes.word() != (0xff00 | soi))
            throw Error("does not start as a JPEG does");
        for (int marker = next_marker(); marker != sos; marker = next_marker())
            read(marker, segment());
        read_scan(segment());
    }

    const Frame& frame() const { return m_frame; }
    const HuffmanDecoder& table(int component) const
    {
        return *m_tables[std::size_t(m_frame.tables[std::size_t(component)])];
    }
    /// What follows: the samples.
    Segment rest() const { return m_bytes; }

private:
    int next_marker()
    {
        if (m_bytes.byte() != 0xff)
            throw Error("has other bytes where a marker must be: it is damaged");
        int marker = m_bytes.byte();
        while (marker == 0xff)
            marker = m_bytes.byte();
        if (marker == eoi)
            throw Error("holds no samples");
        return marker;
    }

    Segment segment()
    {
        const int length = m_bytes.word();
        if (length < 2)
            throw Error("has a segment of " + std::to_string(length) + " bytes");
        const std::size_t size = std::size_t(length) - 2;
        const std::uint8_t* const begin = m_bytes.skip(size);
        return { begin, begin + size };
    }

    void read(int marker, Segment segment)
    {
        if (marker == sof3)
            read_frame(segment);
        else if (marker == dht)
            read_tables(segment);
        else if (is_other_frame(marker))
            throw Error("is of process SOF" + std::to_string(marker - sof0)
                        + "; only lossless JPEG, SOF3, keeps a mosaic");
        else if (marker == dri && segment.word() != 0)
            throw Error("has restart intervals, which are not read");
    }

    void read_frame(Segment segment)
    {
        m_frame.precision = segment.byte();
        m_frame.lines = std::uint64_t(segment.word());
        m_frame.columns = std::uint64_t(segment.word());
        m_frame.components = segment.byte();
        if (m_frame.precision < 2 || m_frame.precision > 16)
            throw Error("has " + std::to_string(m_frame.precision)
                        + " bits a sample; allowed: 2 to 16");
        if (m_frame.components < 1 || m_frame.components > most_components)
            throw Error("has " + std::to_string(m_frame.components)
                        + " components; allowed: 1 to 4");
        for (int c = 0; c < m_frame.components; ++c) {
            m_frame.names[std::size_t(c)] = segment.byte();
            if (segment.byte() != 0x11)
                throw Error("has components of different sizes");
            segment.byte(); // a table of quantisation, of which there is none
        }
    }

    void read_tables(Segment segment)
    {
        while (segment.left() > 0) {
            const int place = segment.byte(); // class 0 above, number below
            const std::uint8_t* const counts = segment.skip(16);
            const int values = std::accumulate(counts, counts + 16, 0);
            if (place >= int(m_tables.size()) || values > 256)
                throw Error("has a Huffman table that lossless JPEG does not know");
            m_tables[std::size_t(place)].emplace(
                counts, segment.skip(std::size_t(values)), std::size_t(values));
        }
    }

    void read_scan(Segment segment)
    {
        if (m_frame.components == 0)
            throw Error("has no SOF3 before its samples");
        if (segment.byte() != m_frame.components)
            throw Error("has several scans; a DNG's has all components in one");
        for (int c = 0; c < m_frame.components; ++c) {
            const int name = segment.byte();
            const int table = segment.byte() >> 4;
            if (name != m_frame.names[std::size_t(c)] || table >= int(m_tables.size())
                || !m_tables[std::size_t(table)])
                throw Error("has a scan of a component or a table that it lacks");
            m_frame.tables[std::size_t(c)] = table;
        }
        m_frame.predictor = segment.byte();
        segment.byte();
        if (m_frame.predictor < 1 || m_frame.predictor > predictors)
            throw Error("has predictor " + std::to_string(m_frame.predictor)
                        + "; allowed: 1 to 7");
        if (segment.byte() != 0)
            throw Error("has a point transform, which drops bits");
    }

    Segment m_bytes;
    Frame m_frame;
    std::array<std::optional<HuffmanDecoder>, most_components> m_tables;
};

class Decoder {
public:
    Decoder(const Headers& headers, std::uint16_t* out)
        : m_frame(headers.frame())
        , m_bits(begin_of(headers), begin_of(headers) + headers.rest().left())
        , m_step(std::size_t(m_frame.components))
        , m_width(m_step * m_frame.columns)
        , m_out(out)
    {
        for (int c = 0; c < m_frame.components; ++c)
            m_tables[std::size_t(c)] = &headers.table(c);
    }

    void run()
    {
        constexpr void (Decoder::*rows[])() = {
            &Decoder::row<1>, &Decoder::row<2>, &Decoder::row<3>, &Decoder::row<4>,
            &Decoder::row<5>, &Decoder::row<6>, &Decoder::row<7>,
        };
        for (std::uint64_t line = 0; line < m_frame.lines; ++line, m_out += m_width) {
            if (line == 0)
                row<1>();
            else
                (this->*rows[m_frame.predictor - 1])();
            m_above = m_out;
            if (m_bits.overrun())
                throw Error("ends in line " + std::to_string(line) + " of "
                            + std::to_string(m_frame.lines)
                            + ": it is truncated or damaged");
        }
    }

private:
    static const std::uint8_t* begin_of(const Headers& headers)
    {
        Segment rest = headers.rest();
        return rest.skip(0);
    }

    /// A line's first pixel is predicted by the one above it, the very first by half
    /// the range.
    template <int predictor> void row()
    {
        for (std::size_t i = 0; i < m_step; ++i)
            m_out[i]
                = std::uint16_t((m_above ? m_above[i] : 1U << (m_frame.precision - 1))
                                + m_tables[i]->difference(m_bits));
        for (std::size_t i = m_step; i < m_width; i += m_step)
            for (std::size_t c = i; c < i + m_step; ++c) {
                const int above = predictor == 1 ? 0 : m_above[c];
                const int corner = predictor == 1 ? 0 : m_above[c - m_step];
                m_out[c] = std::uint16_t(
                    predicted<predictor>(m_out[c - m_step], above, corner)
                    + m_tables[c - i]->difference(m_bits));
            }
    }

    const Frame& m_frame;
    BitReader m_bits;
    std::size_t m_step, m_width;
    std::uint16_t* m_out;
    const std::uint16_t* m_above = nullptr;
    std::array<const HuffmanDecoder*, most_components> m_tables {};
};

} // namespace

void decode_lossless_jpeg(const std::vector<std::uint8_t>& jpeg, std::uint16_t* out,
                          std::uint64_t count)
{
    const Headers headers({ jpeg.data(), jpeg.data() + jpeg.size() });
    const Frame& frame = headers.frame();
    const std::uint64_t samples
        = frame.lines * frame.columns * std::uint64_t(frame.components);
    if (samples != count || count == 0)
        throw Error("has " + std::to_string(frame.lines) + " lines of "
                    + std::to_string(frame.columns) + " x "
                    + std::to_string(frame.components) + " samples, not "
                    + std::to_string(count) + " in all");
    Decoder(headers, out).run();
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "jpeg/lossless.h"

#include "jpeg/huffman.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

namespace cg2raw {

namespace {

/// Of the JPEG; dcraw widens what has two only where there are filters.
int components_of(Size repeat) { return repeat.width == 1 ? 1 : 2; }

/// Index within @p length that stands for @p i beyond it: the last of the same phase.
int repeated(int i, int length, int repeat)
{
    if (i < length)
        return i;
    const int phase = i % repeat;
    const int last = length - 1 - (length - 1 - phase + repeat) % repeat;
    return phase < length ? last : length - 1;
}

/// The samples of the whole tile, row by row, into @p samples.
void fill_tile(const Plane<const std::uint16_t>& image, Size tile, Size repeat,
               std::vector<std::uint16_t>& samples)
{
    samples.resize(std::size_t(tile.width) * std::size_t(tile.height));
    std::uint16_t* out = samples.data();
    for (int row = 0; row < tile.height; ++row, out += tile.width) {
        const std::uint16_t* const from
            = image.row(repeated(row, image.height, repeat.height));
        std::copy_n(from, image.width, out);
        for (int col = image.width; col < tile.width; ++col)
            out[col] = from[repeated(col, image.width, repeat.width)];
    }
}

int precision(const std::vector<std::uint16_t>& samples, int bits)
{
    std::uint16_t used = 0;
    for (const std::uint16_t sample : samples)
        used = std::uint16_t(used | sample);
    while ((unsigned(used) >> bits) != 0)
        ++bits;
    return bits;
}

/// A size's code with room for the difference's own bits behind it.
struct Symbol {
    std::uint32_t code;
    std::uint32_t mask; ///< of the difference's own bits
    std::uint32_t length; ///< of both
};
using Symbols = std::array<Symbol, 32>;

Symbols symbols_of(const HuffmanCode& code)
{
    Symbols symbols {};
    for (std::size_t size = 0; size < difference_sizes; ++size) {
        const unsigned own = own_bits(int(size));
        symbols[size] = { std::uint32_t(code.code[size]) << own, (1U << own) - 1,
                          code.length[size] + own };
    }
    return symbols;
}

/// Bits, highest first, eight bytes stored at a time, without a branch.
class BitWriter {
public:
    explicit BitWriter(std::uint8_t* out)
        : m_out(out)
    {
    }

    /// @p count is up to 56.
    void put(std::uint64_t value, unsigned count)
    {
        m_pending |= value << (64 - m_fill - count);
        for (int byte = 0; byte < 8; ++byte) // one byte-swapped store
            m_out[byte] = std::uint8_t(m_pending >> (56 - 8 * byte));
        const unsigned fill = m_fill + count;
        m_out += fill / 8;
        m_pending <<= fill & ~7U;
        m_fill = fill % 8;
    }

    /// Fills the last byte with ones; one past the end.
    std::uint8_t* finish()
    {
        if (m_fill > 0)
            put((1U << (8 - m_fill)) - 1, 8 - m_fill);
        return m_out;
    }

private:
    std::uint8_t* m_out;
    std::uint64_t m_pending = 0; ///< from the top
    unsigned m_fill = 0; ///< bits pending, below 8
};

/// A negative difference is coded as one less, in the low bits. T.81, F.1.2.1.
std::uint32_t coded(std::uint16_t difference, const Symbol& symbol)
{
    const std::uint32_t negative = difference >> 15;
    return symbol.code | ((std::uint32_t(difference) - negative) & symbol.mask);
}

/// Codes all differences; two of up to 31 bits make one store where they fit.
void write_bits(const Symbols& symbols, JpegScratch& scratch)
{
    constexpr std::size_t longest = 4; // bytes of one difference: 16 + 15 bits
    const std::size_t count = scratch.differences.values.size();
    scratch.bits.resize(longest * count + 16);
    BitWriter bits(scratch.bits.data());
    const std::uint16_t* const difference = scratch.differences.values.data();
    const std::uint8_t* const size = scratch.differences.sizes.data();
    for (std::size_t i = 0; i < count; i += 2) {
        const Symbol& a = symbols[size[i] & 31];
        const Symbol& b = symbols[size[i + 1] & 31];
        const std::uint64_t first = coded(difference[i], a);
        const std::uint64_t second = coded(difference[i + 1], b);
        if (a.length + b.length <= 56) {
            bits.put(first << b.length | second, a.length + b.length);
        } else {
            bits.put(first, a.length);
            bits.put(second, b.length);
        }
    }
    scratch.bits.resize(std::size_t(bits.finish() - scratch.bits.data()));
}

void put16(std::vector<std::uint8_t>& jpeg, unsigned value)
{
    jpeg.push_back(std::uint8_t(value >> 8));
    jpeg.push_back(std::uint8_t(value));
}

/// SOI, DHT, SOF3 and SOS.
void write_head(const JpegCoding& coding, int bits, const HuffmanCode& code,
                std::vector<std::uint8_t>& jpeg)
{
    const JpegLines& lines = coding.lines;
    const int components = lines.components;
    put16(jpeg, 0xffd8);
    put16(jpeg, 0xffc4);
    put16(jpeg, unsigned(2 + 1 + 16 + code.sizes.size()));
    jpeg.push_back(0); // class DC, table 0
    jpeg.insert(jpeg.end(), code.count_of_length.begin(), code.count_of_length.end());
    jpeg.insert(jpeg.end(), code.sizes.begin(), code.sizes.end());

    put16(jpeg, 0xffc3);
    put16(jpeg, 8 + 3 * components);
    jpeg.push_back(std::uint8_t(bits));
    put16(jpeg, unsigned(lines.count));
    put16(jpeg, unsigned(lines.width / components));
    jpeg.push_back(std::uint8_t(components));
    for (int c = 0; c < components; ++c)
        jpeg.insert(jpeg.end(),
                    { std::uint8_t(c), 0x11, 0 }); // no subsampling, no quantisation

    put16(jpeg, 0xffda);
    put16(jpeg, 6 + 2 * components);
    jpeg.push_back(std::uint8_t(components));
    for (int c = 0; c < components; ++c)
        jpeg.insert(jpeg.end(), { std::uint8_t(c), 0 }); // Huffman table 0
    jpeg.insert(jpeg.end(), { std::uint8_t(coding.predictor), 0, 0 });
}

/// Entropy-coded bytes; a 0 follows each 0xff, which else would start a marker.
void append_stuffed(const std::vector<std::uint8_t>& bits,
                    std::vector<std::uint8_t>& jpeg)
{
    const std::uint8_t* at = bits.data();
    const std::uint8_t* const end = at + bits.size();
    while (at < end) {
        const void* const found = std::memchr(at, 0xff, std::size_t(end - at));
        const std::uint8_t* const stop
            = found ? static_cast<const std::uint8_t*>(found) + 1 : end;
        jpeg.insert(jpeg.end(), at, stop);
        if (found)
            jpeg.push_back(0);
        at = stop;
    }
}

} // namespace

void encode_lossless_jpeg(const Plane<const std::uint16_t>& image, Size tile,
                          Size repeat, int bits, Prediction prediction,
                          JpegScratch& scratch, std::vector<std::uint8_t>& jpeg)
{
    assert(tile.width % 2 == 0 && tile.width <= 65534);
    assert(image.width > 0 && image.width <= tile.width);
    assert(image.height > 0 && image.height <= tile.height && tile.height <= 65535);
    assert(bits >= 2 && bits <= 16);
    fill_tile(image, tile, repeat, scratch.samples);
    bits = precision(scratch.samples, bits);
    const int components = components_of(repeat);
    const std::uint16_t* const samples = scratch.samples.data();
    const JpegCoding coding = prediction == Prediction::left
        ? JpegCoding { { samples, tile.width, tile.height, components }, 1 }
        : best_coding(samples, tile.width, tile.height, components,
                      scratch.differences);
    find_differences(coding, bits, scratch.differences);
    const HuffmanCode code = huffman_code(histogram_of(scratch.differences.sizes));
    write_bits(symbols_of(code), scratch);
    jpeg.clear();
    write_head(coding, bits, code, jpeg);
    append_stuffed(scratch.bits, jpeg);
    put16(jpeg, 0xffd9);
}

} // namespace cg2raw

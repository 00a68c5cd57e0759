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

constexpr int most_components = 2;
/// The only predictor that every reader knows: RawSpeed (darktable) refuses 2 to 7.
constexpr std::uint8_t predictor = 1;

/// Of the JPEG; dcraw widens what has two only where there are filters.
int components_of(Size repeat) { return repeat.width == 1 ? 1 : most_components; }

/// Index within @p length that stands for @p i beyond it: the last of the same phase.
int repeated(int i, int length, int repeat)
{
    if (i < length)
        return i;
    const int phase = i % repeat;
    const int last = length - 1 - (length - 1 - phase + repeat) % repeat;
    return phase < length ? last : length - 1;
}

/// A row of the tile: the image's own where it spans the tile, else its padded copy.
const std::uint16_t* tile_row(const Plane<const std::uint16_t>& image, Size tile,
                              Size repeat, int row, std::uint16_t* padded)
{
    const std::uint16_t* const from
        = image.row(repeated(row, image.height, repeat.height));
    if (image.width == tile.width)
        return from;
    std::copy_n(from, image.width, padded);
    for (int col = image.width; col < tile.width; ++col)
        padded[col] = from[repeated(col, image.width, repeat.width)];
    return padded;
}

/// All bits that occur in the image.
std::uint16_t used_bits(const Plane<const std::uint16_t>& image)
{
    std::uint16_t used = 0;
    for (int row = 0; row < image.height; ++row) {
        const std::uint16_t* const from = image.row(row);
        for (int col = 0; col < image.width; ++col)
            used = std::uint16_t(used | from[col]);
    }
    return used;
}

int precision(const Plane<const std::uint16_t>& image, int bits)
{
    const unsigned used = used_bits(image);
    while ((used >> bits) != 0)
        ++bits;
    return bits;
}

/// Differences from the prediction, modulo 2^16: the left neighbour of the same
/// component; for a row's first pixels the ones above, for the first row's half the
/// range.
void find_differences(const Plane<const std::uint16_t>& image, Size tile, Size repeat,
                      int bits, JpegScratch& scratch)
{
    scratch.padded.resize(std::size_t(tile.width));
    scratch.differences.resize(std::size_t(tile.width) * std::size_t(tile.height));
    const int components = components_of(repeat);
    std::array<std::uint16_t, most_components> above;
    above.fill(std::uint16_t(1U << (bits - 1)));
    std::uint16_t* out = scratch.differences.data();
    for (int row = 0; row < tile.height; ++row, out += tile.width) {
        const std::uint16_t* const in
            = tile_row(image, tile, repeat, row, scratch.padded.data());
        for (int c = 0; c < components; ++c) {
            out[c] = std::uint16_t(in[c] - above[std::size_t(c)]);
            above[std::size_t(c)] = in[c];
        }
        for (int col = components; col < tile.width; ++col)
            out[col] = std::uint16_t(in[col] - in[col - components]);
    }
}

/// Size of each difference: bits of its magnitude, 0 to 16. The exponent of a float is
/// that number, and the loop has no branch and no table, so that compilers vectorise
/// it.
void find_sizes(const std::vector<std::uint16_t>& differences,
                std::vector<std::uint8_t>& sizes)
{
    constexpr int bias = 126; // IEEE 754 binary32: 1.0 has exponent 127 and size 1
    sizes.resize(differences.size());
    const std::uint16_t* const in = differences.data();
    std::uint8_t* const out = sizes.data();
    const std::size_t count = differences.size();
    for (std::size_t i = 0; i < count; ++i) {
        const int difference = std::int16_t(in[i]);
        const float magnitude = float(difference < 0 ? -difference : difference);
        std::int32_t word = 0;
        std::memcpy(&word, &magnitude, sizeof word);
        const int size = (word >> 23) - bias;
        out[i] = std::uint8_t(size < 0 ? 0 : size);
    }
}

/// Four histograms side by side: a run of equal sizes does not wait for its own
/// counter.
SizeHistogram histogram_of(const std::vector<std::uint8_t>& sizes)
{
    std::array<std::array<std::uint32_t, 32>, 4> counts {};
    std::size_t i = 0;
    for (; i + 4 <= sizes.size(); i += 4)
        for (std::size_t lane = 0; lane < 4; ++lane)
            ++counts[lane][sizes[i + lane]];
    for (; i < sizes.size(); ++i)
        ++counts[0][sizes[i]];
    SizeHistogram histogram {};
    for (std::size_t size = 0; size < histogram.size(); ++size)
        for (const auto& lane : counts)
            histogram[size] += lane[size];
    return histogram;
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
        const unsigned own = size == 16 ? 0 : unsigned(size); // 32768 is its size alone
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
    const std::size_t count = scratch.differences.size();
    scratch.bits.resize(longest * count + 16);
    BitWriter bits(scratch.bits.data());
    const std::uint16_t* const difference = scratch.differences.data();
    const std::uint8_t* const size = scratch.sizes.data();
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
void write_head(Size tile, int components, int bits, const HuffmanCode& code,
                std::vector<std::uint8_t>& jpeg)
{
    put16(jpeg, 0xffd8);
    put16(jpeg, 0xffc4);
    put16(jpeg, unsigned(2 + 1 + 16 + code.sizes.size()));
    jpeg.push_back(0); // class DC, table 0
    jpeg.insert(jpeg.end(), code.count_of_length.begin(), code.count_of_length.end());
    jpeg.insert(jpeg.end(), code.sizes.begin(), code.sizes.end());

    put16(jpeg, 0xffc3);
    put16(jpeg, 8 + 3 * components);
    jpeg.push_back(std::uint8_t(bits));
    put16(jpeg, unsigned(tile.height));
    put16(jpeg, unsigned(tile.width / components));
    jpeg.push_back(std::uint8_t(components));
    for (int c = 0; c < components; ++c)
        jpeg.insert(jpeg.end(),
                    { std::uint8_t(c), 0x11, 0 }); // no subsampling, no quantisation

    put16(jpeg, 0xffda);
    put16(jpeg, 6 + 2 * components);
    jpeg.push_back(std::uint8_t(components));
    for (int c = 0; c < components; ++c)
        jpeg.insert(jpeg.end(), { std::uint8_t(c), 0 }); // Huffman table 0
    jpeg.insert(jpeg.end(), { predictor, 0, 0 });
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
                          Size repeat, int bits, JpegScratch& scratch,
                          std::vector<std::uint8_t>& jpeg)
{
    const int components = components_of(repeat);
    assert(tile.width % 2 == 0 && tile.width <= components * 65535);
    assert(image.width > 0 && image.width <= tile.width);
    assert(image.height > 0 && image.height <= tile.height && tile.height <= 65535);
    assert(bits >= 2 && bits <= 16);
    bits = precision(image, bits);
    find_differences(image, tile, repeat, bits, scratch);
    find_sizes(scratch.differences, scratch.sizes);
    const HuffmanCode code = huffman_code(histogram_of(scratch.sizes));
    write_bits(symbols_of(code), scratch);
    jpeg.clear();
    write_head(tile, components, bits, code, jpeg);
    append_stuffed(scratch.bits, jpeg);
    put16(jpeg, 0xffd9);
}

} // namespace cg2raw

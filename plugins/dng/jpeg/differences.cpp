// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "jpeg/differences.h"

#include "jpeg/predictor.h"

#include <array>
#include <cassert>
#include <cstring>

namespace cg2raw {

namespace {

/// One line of so many counts where codings are compared.
constexpr int line_step = 8;

/// All but the first pixel of a line.
template <int predictor>
void predict_line(const std::uint16_t* in, const std::uint16_t* above, int width,
                  int components, std::uint16_t* out)
{
    for (int i = components; i < width; ++i)
        out[i] = std::uint16_t(in[i]
                               - predicted<predictor>(in[i - components], above[i],
                                                      above[i - components]));
}

/// A line that has one above it.
void predict_line(int predictor, const std::uint16_t* in, const JpegLines& lines,
                  std::uint16_t* out)
{
    constexpr decltype(&predict_line<1>) by_predictor[predictors]
        = { predict_line<1>, predict_line<2>, predict_line<3>, predict_line<4>,
            predict_line<5>, predict_line<6>, predict_line<7> };
    const std::uint16_t* const above = in - lines.width;
    for (int c = 0; c < lines.components; ++c)
        out[c] = std::uint16_t(in[c] - above[c]);
    by_predictor[predictor - 1](in, above, lines.width, lines.components, out);
}

/// Size of each difference. The exponent of a float is the number of its magnitude's
/// bits, and the loop has no branch and no table, so that compilers vectorise it.
void find_sizes(Differences& differences)
{
    constexpr int bias = 126; // IEEE 754 binary32: 1.0 has exponent 127 and size 1
    const std::size_t count = differences.values.size();
    differences.sizes.resize(count);
    const std::uint16_t* const in = differences.values.data();
    std::uint8_t* const out = differences.sizes.data();
    for (std::size_t i = 0; i < count; ++i) {
        const int difference = std::int16_t(in[i]);
        const float magnitude = float(difference < 0 ? -difference : difference);
        std::int32_t word = 0;
        std::memcpy(&word, &magnitude, sizeof word);
        const int size = (word >> 23) - bias;
        out[i] = std::uint8_t(size < 0 ? 0 : size);
    }
}

/// Bits of all differences of these sizes, by the code made for them.
std::uint64_t coded_bits(const SizeHistogram& histogram)
{
    const HuffmanCode code = huffman_code(histogram);
    std::uint64_t bits = 0;
    for (std::size_t size = 0; size < histogram.size(); ++size)
        bits += histogram[size] * (code.length[size] + own_bits(int(size)));
    return bits;
}

/// Bits of every eighth line, from the second on.
std::uint64_t sampled_bits(const JpegLines& lines, int predictor, Differences& scratch)
{
    const std::size_t width = std::size_t(lines.width);
    const std::size_t count = std::size_t((lines.count + line_step - 2) / line_step);
    scratch.values.resize(width * count);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t line = 1 + line_step * i;
        predict_line(predictor, lines.samples + line * width, lines,
                     scratch.values.data() + i * width);
    }
    find_sizes(scratch);
    return coded_bits(histogram_of(scratch.sizes));
}

} // namespace

void find_differences(const JpegCoding& coding, int bits, Differences& differences)
{
    const auto& [lines, predictor] = coding;
    assert(predictor >= 1 && predictor <= predictors);
    const std::size_t width = std::size_t(lines.width);
    differences.values.resize(width * std::size_t(lines.count));
    std::uint16_t* out = differences.values.data();
    const std::uint16_t* in = lines.samples;
    for (int c = 0; c < lines.components; ++c)
        out[c] = std::uint16_t(in[c] - (1U << (bits - 1)));
    predict_line<1>(in, in, lines.width, lines.components, out);
    for (int line = 1; line < lines.count; ++line) {
        in += width;
        out += width;
        predict_line(predictor, in, lines, out);
    }
    find_sizes(differences);
}

SizeHistogram histogram_of(const std::vector<std::uint8_t>& sizes)
{
    // Four side by side: a run of equal sizes does not wait for its own counter.
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

JpegCoding best_coding(const std::uint16_t* samples, int width, int height,
                       int components, Differences& scratch)
{
    assert(height % 16 == 0); // the lines of either kind are of equally many samples
    JpegCoding best { { samples, width, height, components }, 1 };
    std::uint64_t fewest = UINT64_MAX;
    for (int rows = 1; rows <= 2; ++rows)
        for (int predictor = 1; predictor <= predictors; ++predictor) {
            const JpegLines lines { samples, rows * width, height / rows, components };
            const std::uint64_t bits = sampled_bits(lines, predictor, scratch);
            if (bits < fewest) {
                best = { lines, predictor };
                fewest = bits;
            }
        }
    return best;
}

} // namespace cg2raw

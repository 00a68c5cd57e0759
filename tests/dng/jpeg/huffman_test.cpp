// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "jpeg/huffman.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <utility>

namespace cg2raw {
namespace {

/// Sum of 2^-length: up to 1 for a code that can be told apart.
double kraft_sum(const HuffmanCode& code)
{
    double sum = 0.0;
    for (const int length : code.length)
        sum += length > 0 ? std::exp2(-length) : 0.0;
    return sum;
}

double mean_bits(const HuffmanCode& code, const SizeHistogram& histogram)
{
    double bits = 0.0, count = 0.0;
    for (std::size_t size = 0; size < histogram.size(); ++size) {
        bits += double(histogram[size]) * code.length[size];
        count += double(histogram[size]);
    }
    return bits / count;
}

double entropy(const SizeHistogram& histogram)
{
    const double count
        = std::accumulate(histogram.begin(), histogram.end(), 0.0,
                          [](double sum, std::uint64_t n) { return sum + double(n); });
    double bits = 0.0;
    for (const std::uint64_t n : histogram)
        bits -= n > 0 ? double(n) / count * std::log2(double(n) / count) : 0.0;
    return bits;
}

void expect_legal(const HuffmanCode& code, const SizeHistogram& histogram)
{
    int listed = 0;
    for (std::size_t size = 0; size < histogram.size(); ++size) {
        const int length = code.length[size];
        EXPECT_EQ(length > 0, histogram[size] > 0) << "size " << size;
        EXPECT_LE(length, 16);
        if (length > 0) {
            ++listed;
            EXPECT_NE(code.code[size], (1 << length) - 1) << "all ones, size " << size;
        }
        for (std::size_t other = 0; other < histogram.size(); ++other) {
            if (other != size && length > 0 && code.length[other] >= length) {
                EXPECT_NE(code.code[other] >> (code.length[other] - length),
                          code.code[size])
                    << "size " << size << " is a prefix of " << other;
            }
        }
    }
    EXPECT_EQ(int(code.sizes.size()), listed);
    EXPECT_LT(kraft_sum(code), 1.0) << "no room for the forbidden code";
}

TEST(Huffman, OneSizeTakesOneBit)
{
    SizeHistogram histogram {};
    histogram[5] = 1000;
    const HuffmanCode code = huffman_code(histogram);
    expect_legal(code, histogram);
    EXPECT_EQ(code.length[5], 1);
    EXPECT_EQ(code.code[5], 0);
}

TEST(Huffman, AllSizesEquallyOften)
{
    SizeHistogram histogram;
    histogram.fill(7);
    const HuffmanCode code = huffman_code(histogram);
    expect_legal(code, histogram);
    // 17 sizes and the forbidden code: 14 of 4 bits and 4 of 5.
    EXPECT_NEAR(mean_bits(code, histogram), (14 * 4 + 3 * 5) / 17.0, 1e-12);
}

TEST(Huffman, FibonacciCountsStayWithinSixteenBits)
{
    SizeHistogram
        histogram; // the counts of the deepest tree: 17 bits with the 18th leaf
    std::uint64_t a = 1, b = 1;
    for (std::uint64_t& count : histogram) {
        count = a;
        b = std::exchange(a, a + b);
    }
    expect_legal(huffman_code(histogram), histogram);
}

TEST(Huffman, WithinOneBitOfEntropy)
{
    SizeHistogram histogram {};
    for (int size = 0; size < 12; ++size)
        histogram[std::size_t(size)]
            = std::uint64_t(1e5 * std::exp(-0.3 * (size - 5) * (size - 5)));
    const HuffmanCode code = huffman_code(histogram);
    EXPECT_GE(mean_bits(code, histogram), entropy(histogram));
    EXPECT_LE(mean_bits(code, histogram), entropy(histogram) + 0.1);
}

} // namespace
} // namespace cg2raw

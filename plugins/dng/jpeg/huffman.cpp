// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "jpeg/huffman.h"

#include <algorithm>
#include <cassert>

namespace cg2raw {

namespace {

constexpr int max_length = 16;
/// All sizes and one symbol more that never occurs: as the rarest it gets the all-ones
/// code, which JPEG forbids to the others.
constexpr int symbols = difference_sizes + 1;
constexpr int reserved = symbols - 1;

using Weights = std::array<std::uint64_t, symbols>;
using Lengths = std::array<int, symbols>;

/// Index of the lightest tree; of equal ones the last, so that the reserved symbol goes
/// deepest. -1: none.
int lightest(const Weights& weights, int except)
{
    int best = -1;
    for (int i = 0; i < symbols; ++i)
        if (i != except && weights[std::size_t(i)] > 0
            && (best < 0 || weights[std::size_t(i)] <= weights[std::size_t(best)]))
            best = i;
    return best;
}

/// Code lengths by merging the two lightest trees until one is left.
Lengths merged_lengths(Weights weights)
{
    Lengths length {};
    std::array<int, symbols> root {};
    for (int i = 0; i < symbols; ++i)
        root[std::size_t(i)] = i;
    for (;;) {
        const int a = lightest(weights, -1);
        const int b = lightest(weights, a);
        if (b < 0)
            return length;
        weights[std::size_t(b)] += weights[std::size_t(a)];
        weights[std::size_t(a)] = 0;
        for (int i = 0; i < symbols; ++i) {
            int& tree = root[std::size_t(i)];
            length[std::size_t(i)] += tree == a || tree == b;
            tree = tree == a ? b : tree;
        }
    }
}

/// Lengths up to 16: flatter weights make a flatter tree.
Lengths limited_lengths(Weights weights)
{
    for (;;) {
        const Lengths length = merged_lengths(weights);
        if (*std::max_element(length.begin(), length.end()) <= max_length)
            return length;
        for (std::uint64_t& weight : weights)
            weight = (weight + 1) / 2;
    }
}

} // namespace

HuffmanCode huffman_code(const SizeHistogram& histogram)
{
    Weights weights {};
    for (std::size_t size = 0; size < histogram.size(); ++size)
        weights[size] = 2 * histogram[size]; // every size weighs more than the reserved
    weights[reserved] = 1;
    const Lengths length = limited_lengths(weights);

    HuffmanCode result;
    std::uint16_t next = 0;
    for (int bits = 1; bits <= max_length; ++bits, next = std::uint16_t(next << 1))
        for (int size = 0; size < difference_sizes; ++size)
            if (length[std::size_t(size)] == bits) {
                result.code[std::size_t(size)] = next++;
                result.length[std::size_t(size)] = std::uint8_t(bits);
                ++result.count_of_length[std::size_t(bits - 1)];
                result.sizes.push_back(std::uint8_t(size));
            }
    assert(!result.sizes.empty());
    return result;
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/random.h"

#include "elementary.h"
#include "multiversion.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace cg2raw {
namespace {

/// Philox 4x32: multipliers and Weyl constants. Source: Salmon et al., SC 2011,
/// table 2.
constexpr std::uint32_t multiplier_0 = 0xD2511F53, multiplier_1 = 0xCD9E8D57;
constexpr std::uint32_t weyl_0 = 0x9E3779B9, weyl_1 = 0xBB67AE85;
constexpr int rounds = 10;

/// Counters that are worked on side by side, so that the compiler vectorises.
constexpr int lanes = 16;
/// Normals of one counter: two Box-Muller pairs.
constexpr int per_counter = 4;

struct Words {
    std::uint32_t word[4][lanes];
};

inline void philox(Words& w, std::uint32_t key_0, std::uint32_t key_1)
{
    for (int round = 0; round < rounds; ++round) {
        for (int i = 0; i < lanes; ++i) {
            const std::uint64_t p0 = std::uint64_t(multiplier_0) * w.word[0][i];
            const std::uint64_t p1 = std::uint64_t(multiplier_1) * w.word[2][i];
            w.word[0][i] = std::uint32_t(p1 >> 32) ^ w.word[1][i] ^ key_0;
            w.word[1][i] = std::uint32_t(p1);
            w.word[2][i] = std::uint32_t(p0 >> 32) ^ w.word[3][i] ^ key_1;
            w.word[3][i] = std::uint32_t(p0);
        }
        key_0 += weyl_0;
        key_1 += weyl_1;
    }
}

/// Natural logarithm of 0 < x <= 1, relative error below 2e-7; a polynomial of ours,
/// not libm's, so that every machine has the same bits.
inline float log_of(float x)
{
    std::int32_t bits = 0;
    std::memcpy(&bits, &x, sizeof bits);
    const std::int32_t exponent = (bits - 0x3F3504F3) >> 23; // 0x3F3504F3 = sqrt(1/2)
    bits -= exponent * (1 << 23);
    float mantissa = 0.0f;
    std::memcpy(&mantissa, &bits, sizeof mantissa);
    const float f = mantissa - 1.0f; // -0.2929 ... 0.4142
    float p = 0.0874394535f;
    p = p * f - 0.143773306f;
    p = p * f + 0.149490955f;
    p = p * f - 0.16560696f;
    p = p * f + 0.199569775f;
    p = p * f - 0.250021535f;
    p = p * f + 0.333341833f;
    p = p * f - 0.49999987f;
    p = p * f + 0.999999974f;
    return float(exponent) * 0.693147181f + p * f;
}

/// Standard normals from two words, by Box-Muller; the tail reaches 6.7 sigma.
inline void normal_pair_of(std::uint32_t a, std::uint32_t b, float& first,
                           float& second)
{
    const float u = (float(std::int32_t(a >> 1)) + 0.5f) * 4.65661287e-10f; // 2^-31
    const float radius = std::sqrt(std::max(0.0f, -2.0f * log_of(u)));
    const std::uint32_t quadrant = (b + 0x20000000u) >> 30;
    const float x
        = float(std::int32_t(b - (quadrant << 30))) * 1.46291808e-9f; // 2 pi / 2^32
    const float square = x * x;
    const float sine = x
        * ((((-0.000195039631f) * square + 0.00833203633f) * square - 0.166666507f)
               * square
           + 0.999999997f);
    const float cosine
        = ((((2.43798803e-05f) * square - 0.00138866186f) * square + 0.0416666167f)
               * square
           - 0.499999996f)
            * square
        + 1.0f;
    const bool swapped = quadrant & 1;
    const float cosine_part = swapped ? sine : cosine,
                sine_part = swapped ? cosine : sine;
    first = radius * (quadrant == 1 || quadrant == 2 ? -cosine_part : cosine_part);
    second = radius * (quadrant >= 2 ? -sine_part : sine_part);
}

/// Words of the counters first_group ... first_group + lanes - 1 of a row.
inline void draw_words(std::uint32_t first_group, std::uint32_t row,
                       std::uint64_t frame, std::uint64_t key, Words& w)
{
    for (int i = 0; i < lanes; ++i) {
        w.word[0][i] = first_group + std::uint32_t(i);
        w.word[1][i] = row;
        w.word[2][i] = std::uint32_t(frame);
        w.word[3][i] = std::uint32_t(frame >> 32);
    }
    philox(w, std::uint32_t(key), std::uint32_t(key >> 32));
}

/// Normals of a group of counters.
CG2RAW_MULTIVERSION void draw_normals(std::uint32_t first_group, std::uint32_t row,
                                      std::uint64_t frame, std::uint64_t key,
                                      float* normals)
{
    Words w;
    draw_words(first_group, row, frame, key, w);
    float value[per_counter][lanes];
    for (int i = 0; i < lanes; ++i)
        normal_pair_of(w.word[0][i], w.word[1][i], value[0][i], value[1][i]);
    for (int i = 0; i < lanes; ++i)
        normal_pair_of(w.word[2][i], w.word[3][i], value[2][i], value[3][i]);
    for (int i = 0; i < lanes; ++i)
        for (int k = 0; k < per_counter; ++k)
            normals[per_counter * i + k] = value[k][i];
}

/// (n + 1/2) / 2^52 with the 52 upper bits n of two words; exact.
inline double uniform_of(std::uint32_t high, std::uint32_t low)
{
    // As the mantissa of a number in 1 ... 2.
    const std::uint64_t bits
        = 0x3FF0000000000000u | (std::uint64_t(high) << 20 | low >> 12);
    double value = 0.0;
    std::memcpy(&value, &bits, sizeof value);
    return (value - 1.0) + 0x1p-53;
}

/// Uniforms of a group of counters.
CG2RAW_MULTIVERSION void draw_uniforms(std::uint32_t first_group, std::uint32_t row,
                                       std::uint64_t frame, std::uint64_t key,
                                       double* uniforms)
{
    Words w;
    draw_words(first_group, row, frame, key, w);
    for (std::ptrdiff_t i = 0; i < lanes; ++i) {
        uniforms[2 * i] = uniform_of(w.word[0][i], w.word[1][i]);
        uniforms[2 * i + 1] = uniform_of(w.word[2][i], w.word[3][i]);
    }
}

/// Weights of a row's independent normals in one that correlates with the next by a
/// coefficient: those of an autoregressive process, up to where they are lost in
/// float32, and together of variance 1.
std::vector<float> weights_of(double coefficient)
{
    constexpr double least = 1e-8;
    std::vector<double> powers { 1.0 };
    double square = 1.0;
    while (std::abs(powers.back() * coefficient) > least) {
        powers.push_back(powers.back() * coefficient);
        square += powers.back() * powers.back();
    }
    std::vector<float> weights;
    for (double power : powers)
        weights.push_back(float(power / std::sqrt(square)));
    return weights;
}

/// out[i] += weight * normal[i].
CG2RAW_MULTIVERSION void add_weighted(const float* normal, float weight, int count,
                                      float* out)
{
    for (int i = 0; i < count; ++i)
        out[i] += weight * normal[i];
}

/// Draws of the sites at ... at + count - 1, from whole groups of counters.
template <int each, class Value, class Draw>
void copy_groups(Site at, int count, const Draw& draw, Value* out)
{
    constexpr int per_draw = lanes * each;
    Value drawn[per_draw];
    const int end = at.col + count;
    for (int first = at.col / each * each; first < end; first += per_draw) {
        draw(std::uint32_t(first / each), std::uint32_t(at.row), drawn);
        const int from = std::max(at.col, first), to = std::min(end, first + per_draw);
        std::copy(drawn + (from - first), drawn + (to - first), out + (from - at.col));
    }
}

/// FNV-1a of 64 bits, then SplitMix64's finaliser: names and numbers to keys.
std::uint64_t hashed(std::uint64_t seed, std::string_view purpose)
{
    std::uint64_t hash = 0xCBF29CE484222325u;
    for (const char c : purpose)
        hash = (hash ^ std::uint8_t(c)) * 0x100000001B3u;
    for (int byte = 0; byte < 8; ++byte)
        hash = (hash ^ (seed >> (8 * byte) & 0xFF)) * 0x100000001B3u;
    hash = (hash ^ (hash >> 30)) * 0xBF58476D1CE4E5B9u;
    hash = (hash ^ (hash >> 27)) * 0x94D049BB133111EBu;
    return hash ^ (hash >> 31);
}

} // namespace

std::array<std::uint32_t, 4> philox_words(const std::array<std::uint32_t, 4>& counter,
                                          const std::array<std::uint32_t, 2>& key)
{
    Words w {};
    for (std::size_t i = 0; i < 4; ++i)
        w.word[i][0] = counter[i];
    philox(w, key[0], key[1]);
    return { w.word[0][0], w.word[1][0], w.word[2][0], w.word[3][0] };
}

Rng::Rng(std::uint64_t seed, std::string_view purpose, std::int64_t frame)
    : m_key(hashed(seed, purpose))
    , m_fixed_key(hashed(0, purpose))
    , m_frame(std::uint64_t(frame))
{
}

Rng Rng::other(std::string_view purpose) const
{
    Rng stream = *this;
    stream.m_key = hashed(m_key, purpose);
    stream.m_fixed_key = hashed(m_fixed_key, purpose);
    return stream;
}

Rng Rng::fixed() const
{
    Rng stream = *this;
    stream.m_key = m_fixed_key;
    stream.m_frame = 0;
    return stream;
}

Rng Rng::correlated(double coefficient) const
{
    Rng stream = *this;
    stream.m_weights = weights_of(coefficient);
    return stream;
}

void Rng::normals(Site at, int count, float* out) const
{
    if (m_weights.empty()) {
        independent_normals(at, count, out);
        return;
    }
    // A row begins with the normals of columns that no sensor has: none is negative.
    const int before = int(m_weights.size()) - 1;
    std::vector<float> normal(std::size_t(count + before));
    independent_normals(at, count + before, normal.data());
    std::fill_n(out, count, 0.0f);
    for (int back = 0; back <= before; ++back)
        add_weighted(normal.data() + (before - back), m_weights[std::size_t(back)],
                     count, out);
}

void Rng::independent_normals(Site at, int count, float* out) const
{
    copy_groups<per_counter>(
        at, count,
        [this](std::uint32_t group, std::uint32_t row, float* drawn) {
            draw_normals(group, row, m_frame, m_key, drawn);
        },
        out);
}

void Rng::uniforms(Site at, int count, double* out) const
{
    constexpr std::uint64_t other_stream = 0x9E3779B97F4A7C15u; // golden ratio
    copy_groups<2>(
        at, count,
        [this](std::uint32_t group, std::uint32_t row, double* drawn) {
            draw_uniforms(group, row, m_frame, m_key ^ other_stream, drawn);
        },
        out);
}

double Rng::uniform(std::uint32_t n) const
{
    const auto w
        = philox_words({ n, 0, std::uint32_t(m_frame), std::uint32_t(m_frame >> 32) },
                       { std::uint32_t(m_key), std::uint32_t(m_key >> 32) });
    const std::uint64_t bits = (std::uint64_t(w[0]) << 32 | w[1]) >> 12;
    return (double(bits) + 0.5) / 4503599627370496.0; // 2^52
}

double Rng::normal(std::uint32_t n) const
{
    const double radius = std::sqrt(-2.0 * natural_log(uniform(2 * n)));
    return radius * std::cos(6.283185307179586 * uniform(2 * n + 1));
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Sharpness of lens, filter stack and pixel aperture, as the departure of a
/// radial OTF from 1: a cosine series of the frequency. The McClellan transform turns
/// each cosine into a small kernel applied as often as its order.
#include "cg2raw/effect.h"

#include "multiversion.h"
#include "neighbours.h"

#include <utility>

namespace cg2raw::effects {
namespace {

constexpr int rings = 10;

/// down[col] = above + 2 here + below, the vertical half of the kernel.
CG2RAW_MULTIVERSION void binomial_down(const float* above, const float* here,
                                       const float* below, int width, float* out)
{
    for (int col = 0; col < width; ++col)
        out[col] = (above[col] + below[col]) + 2.0f * here[col];
}

/// One step of Chebyshev's recursion T[n + 1] = 2 C T[n] - T[n - 1], and D += ring
/// (T[n + 1] - x). C is the kernel [1 2 1; 2 -4 2; 1 2 1] / 8, that is twice the
/// binomial one less the identity. @p down has a column of margin to either side. @p
/// older is replaced.
CG2RAW_MULTIVERSION void recur(const float* down, const float* here, const float* x,
                               float factor, float ring, int width, float* older,
                               float* deviation)
{
    for (int col = 0; col < width; ++col) {
        const float sum = (down[col - 1] + down[col + 1]) + 2.0f * down[col];
        const float next = factor * (0.125f * sum - here[col]) - older[col];
        older[col] = next;
        deviation[col] += ring * (next - x[col]);
    }
}

CG2RAW_MULTIVERSION void add_scaled(const float* deviation, float scale, int width,
                                    float* x)
{
    for (int col = 0; col < width; ++col)
        x[col] += scale * deviation[col];
}

/// Room for one plane on its way; a block's three planes share it.
class Series {
public:
    Series(int width, int height)
        : m_width(width)
        , m_height(height)
        , m_room(3 * std::size_t(width) * std::size_t(height))
        , m_down(std::size_t(width) + 2)
    {
        for (int i = 0; i < 3; ++i)
            m_planes[i] = { m_room.data() + std::ptrdiff_t(i) * width * height, width,
                            height, width };
    }

    /// x += scale D x for the first @p count of @p ring.
    void add_to(const Plane<float>& x, const double* ring, int count, double scale)
    {
        auto& [current, older, deviation] = m_planes;
        std::fill(m_room.begin(), m_room.end(), 0.0f);
        for (int row = 0; row < m_height; ++row)
            std::copy(x.row(row), x.row(row) + m_width, current.row(row));
        for (int n = 0; n < count; ++n) {
            // T[1] = C T[0] is the recursion of half the factor, older being 0.
            step(x, n == 0 ? 1.0f : 2.0f, float(ring[n]));
            std::swap(current, older);
        }
        for (int row = 0; row < m_height; ++row)
            add_scaled(deviation.row(row), float(scale), m_width, x.row(row));
    }

private:
    void step(const Plane<float>& x, float factor, float ring)
    {
        const auto& [current, older, deviation] = m_planes;
        float* const down = m_down.data() + 1;
        for (int row = 0; row < m_height; ++row) {
            binomial_down(current.row(mirrored(row - 1, m_height)), current.row(row),
                          current.row(mirrored(row + 1, m_height)), m_width, down);
            down[-1] = down[mirrored(-1, m_width)];
            down[m_width] = down[mirrored(m_width, m_width)];
            recur(down, current.row(row), x.row(row), factor, ring, m_width,
                  older.row(row), deviation.row(row));
        }
    }

    int m_width, m_height;
    std::vector<float> m_room, m_down;
    std::array<Plane<float>, 3> m_planes;
};

void predict(Signal& signal, const Values& values)
{
    int count = rings;
    while (count > 0 && values[std::size_t(count - 1)] == 0.0)
        --count;
    if (count == 0)
        return;
    const bool one_color = values.size() == rings;
    const double scales[3] = { one_color ? 1.0 : 1.0 + values[rings], 1.0,
                               one_color ? 1.0 : 1.0 + values[rings + 1] };
    Series series(signal.mean[0].width, signal.mean[0].height);
    for (std::size_t plane = 0; plane < 3; ++plane)
        series.add_to(signal.mean[plane], values.data(), count, scales[plane]);
}

} // namespace

Effect blur()
{
    std::vector<Parameter> parameters;
    for (int n = 1; n <= rings; ++n)
        parameters.push_back({ "ring_" + std::to_string(n), "1", -1.0, 1.0, 0.0,
                               "of cos(" + std::to_string(n)
                                   + " w) - 1 in the OTF; w in radians per pixel" });
    parameters.push_back({ "red_scale", "1", -0.9, 2.0, 0.0,
                           "excess of red's OTF deviation over green's, relative",
                           CfaRepeat::other_color });
    parameters.push_back({ "blue_scale", "1", -0.9, 2.0, 0.0,
                           "excess of blue's OTF deviation over green's, relative",
                           CfaRepeat::other_color });
    return { "blur",
             Stage::optics,
             Pattern::none,
             parameters,
             "sharpness of the optics: a radial OTF 1 + sum of ring_n (cos(n w) - 1)",
             "J. H. McClellan, Princeton Conf. on Information Sciences and Systems 7, "
             "1973",
             predict,
             nullptr,
             rings };
}

} // namespace cg2raw::effects

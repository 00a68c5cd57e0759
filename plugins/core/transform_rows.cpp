// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The pixel loops of the transform: interleaved scene rows -> planes of camera
/// RGB.
#include "cg2raw/transform.h"

#include "multiversion.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace cg2raw {
namespace {

/// What an infinite radiance counts as; any sensor clips far below it.
constexpr float largest_radiance = 1e6f;
/// Where highlights begin to lose their colour, and over what range.
/// Source: Brooks et al., Unprocessing Images for Learned Raw Denoising, CVPR 2019.
constexpr float highlight_start = 0.9f, highlight_range = 0.1f;

/// A transform in the arithmetic of pixels.
struct Coefficients {
    float first[9], second[9], gain[3];
    float uplift[3][7]; ///< if it has one
    float highlight; ///< 1: kept, 0: not
    float product_ceiling; ///< of the products
    float ceiling; ///< of the result
    bool two_steps;
};

Coefficients coefficients_of(const CameraTransform& transform)
{
    Coefficients c {};
    std::copy(transform.first.m.begin(), transform.first.m.end(), c.first);
    std::copy(transform.second.m.begin(), transform.second.m.end(), c.second);
    std::copy(transform.gains.begin(), transform.gains.end(), c.gain);
    if (transform.uplift)
        for (std::size_t i = 0; i < 3; ++i)
            std::copy((*transform.uplift)[i].begin(), (*transform.uplift)[i].end(),
                      c.uplift[i]);
    c.highlight = transform.keep_highlights ? 1.0f : 0.0f;
    c.product_ceiling = transform.is_light ? largest_radiance : 1.0f;
    c.ceiling = transform.clip_result ? 1.0f : largest_radiance;
    c.two_steps = transform.two_steps;
    return c;
}

inline float legal(float x, int& nan, int& inf)
{
    const bool is_nan = x != x;
    nan += is_nan;
    inf += std::fabs(x) > 3.402823466e38f;
    const float number = is_nan ? 0.0f : x;
    return std::min(std::max(number, -largest_radiance), largest_radiance);
}

inline float clipped(float x, float ceiling = 1.0f)
{
    return std::min(std::max(x, 0.0f), ceiling);
}

inline float dot(const float m[3], float r, float g, float b)
{
    return m[0] * r + m[1] * g + m[2] * b;
}

inline void multiply(const float m[9], float ceiling, float& r, float& g, float& b)
{
    const float x = clipped(dot(m, r, g, b), ceiling);
    const float y = clipped(dot(m + 3, r, g, b), ceiling);
    b = clipped(dot(m + 6, r, g, b), ceiling);
    r = x;
    g = y;
}

/// The terms of transform_uplift.h times @p m, in place.
inline void uplifted(const float m[3][7], float ceiling, float& red, float& green,
                     float& blue)
{
    const float r = std::max(red, 0.0f), g = std::max(green, 0.0f),
                b = std::max(blue, 0.0f);
    const float rg = std::sqrt(r * g), gb = std::sqrt(g * b), rb = std::sqrt(r * b);
    const float mean = (r + g + b) * (1.0f / 3.0f);
    const float over_mean = 1.0f / std::max(mean, 1e-30f);
    const float even = (r * over_mean) * (g * over_mean) * (b * over_mean);
    const float even_2 = even * even, even_4 = even_2 * even_2;
    const float grey = mean * (even_4 * even_4);
    float result[3];
    for (int c = 0; c < 3; ++c)
        result[c] = clipped(dot(m[c], red, green, blue) + dot(m[c] + 3, rg, gb, rb)
                                + m[c][6] * grey,
                            ceiling);
    red = result[0];
    green = result[1];
    blue = result[2];
}

inline float unbalanced(float x, float gain, float m, float ceiling)
{
    return std::min(x * std::max(m + (1.0f - m) * gain, gain), ceiling);
}

/// Rows are worked on in pieces that stay in the first-level cache.
constexpr int piece = 256;

template <int stride>
CG2RAW_MULTIVERSION void legal_piece(const float* scene, std::ptrdiff_t pixel_stride,
                                     int count, float* r, float* g, float* b, int& nan,
                                     int& inf)
{
    const std::ptrdiff_t step = stride ? stride : pixel_stride;
    int nans = 0, infs = 0;
    for (int i = 0; i < count; ++i) {
        r[i] = legal(scene[i * step], nans, infs);
        g[i] = legal(scene[i * step + 1], nans, infs);
        b[i] = legal(scene[i * step + 2], nans, infs);
    }
    nan += nans;
    inf += infs;
}

/// Whether legal() leaves all of @p count floats as they are: no NaN, none too large.
/// Their bits without the sign, as whole numbers, are in the order of their magnitudes.
CG2RAW_MULTIVERSION bool are_legal(const float* values, std::ptrdiff_t count)
{
    std::int32_t largest = 0, bound = 0;
    std::memcpy(&bound, &largest_radiance, sizeof bound);
    for (std::ptrdiff_t i = 0; i < count; ++i) {
        std::int32_t bits = 0;
        std::memcpy(&bits, values + i, sizeof bits);
        largest = std::max(largest, bits & 0x7fffffff);
    }
    return largest <= bound;
}

/// Pixels of three floats that are all legal, as nearly all are.
CG2RAW_MULTIVERSION void split_piece(const float* scene, int count, float* r, float* g,
                                     float* b)
{
    for (int i = 0; i < count; ++i) {
        r[i] = scene[3 * i];
        g[i] = scene[3 * i + 1];
        b[i] = scene[3 * i + 2];
    }
}

CG2RAW_MULTIVERSION void camera_piece(const Coefficients& c, int count, float* r,
                                      float* g, float* b)
{
    for (int i = 0; i < count; ++i) {
        // Of the mean, but each channel first: near the start the sum would lose
        // digits.
        const float above = (r[i] - highlight_start) + (g[i] - highlight_start)
            + (b[i] - highlight_start);
        const float over = std::max(above, 0.0f) * (1.0f / (3.0f * highlight_range));
        const float m = c.highlight * over * over;
        r[i] = unbalanced(r[i], c.gain[0], m, c.ceiling);
        g[i] = unbalanced(g[i], c.gain[1], m, c.ceiling);
        b[i] = unbalanced(b[i], c.gain[2], m, c.ceiling);
    }
}

CG2RAW_MULTIVERSION void product_piece(const float m[9], float ceiling, int count,
                                       float* r, float* g, float* b)
{
    for (int i = 0; i < count; ++i)
        multiply(m, ceiling, r[i], g[i], b[i]);
}

CG2RAW_MULTIVERSION void uplift_piece(const float m[3][7], float ceiling, int count,
                                      float* r, float* g, float* b)
{
    for (int i = 0; i < count; ++i)
        uplifted(m, ceiling, r[i], g[i], b[i]);
}

CG2RAW_MULTIVERSION void balance_piece(const float gain[3], int count, float* r,
                                       float* g, float* b)
{
    for (int i = 0; i < count; ++i) {
        r[i] = clipped(r[i] / gain[0]);
        g[i] = clipped(g[i] / gain[1]);
        b[i] = clipped(b[i] / gain[2]);
    }
}

/// A product that is not clipped.
CG2RAW_MULTIVERSION void scene_piece(const float m[9], int count, float* r, float* g,
                                     float* b)
{
    for (int i = 0; i < count; ++i) {
        const float x = dot(m, r[i], g[i], b[i]), y = dot(m + 3, r[i], g[i], b[i]);
        b[i] = dot(m + 6, r[i], g[i], b[i]);
        r[i] = x;
        g[i] = y;
    }
}

CG2RAW_MULTIVERSION void exposure_piece(float gain, int count, float* r, float* g,
                                        float* b)
{
    for (int i = 0; i < count; ++i) {
        r[i] *= gain;
        g[i] *= gain;
        b[i] *= gain;
    }
}

void expose(float gain, int count, float* r, float* g, float* b)
{
    if (gain != 1.0f)
        exposure_piece(gain, count, r, g, b);
}

void make_legal(const float* scene, std::ptrdiff_t stride, int count, float* r,
                float* g, float* b, Illegal& illegal)
{
    int nan = 0, inf = 0;
    if (stride == 3 && are_legal(scene, std::ptrdiff_t(3) * count))
        split_piece(scene, count, r, g, b);
    else if (stride == 3)
        legal_piece<3>(scene, stride, count, r, g, b, nan, inf);
    else if (stride == 4)
        legal_piece<4>(scene, stride, count, r, g, b, nan, inf);
    else
        legal_piece<0>(scene, stride, count, r, g, b, nan, inf);
    illegal.nan += nan;
    illegal.inf += inf;
}

} // namespace

void to_camera(const CameraTransform& transform, const float* scene,
               std::ptrdiff_t pixel_stride, int width, float* const camera[3],
               Illegal& illegal)
{
    const Coefficients c = coefficients_of(transform);
    for (int start = 0; start < width; start += piece) {
        const int count = std::min(piece, width - start);
        float *r = camera[0] + start, *g = camera[1] + start, *b = camera[2] + start;
        make_legal(scene + start * pixel_stride, pixel_stride, count, r, g, b, illegal);
        expose(transform.exposure, count, r, g, b);
        if (transform.uplift)
            uplift_piece(c.uplift, c.product_ceiling, count, r, g, b);
        else
            product_piece(c.first, c.product_ceiling, count, r, g, b);
        if (c.two_steps)
            product_piece(c.second, c.product_ceiling, count, r, g, b);
        camera_piece(c, count, r, g, b);
    }
}

void to_scene(const SceneTransform& transform, const float* camera,
              std::ptrdiff_t pixel_stride, int width, float* const scene[3],
              Illegal& illegal)
{
    float first[9], second[9], gain[3];
    std::copy(transform.first.m.begin(), transform.first.m.end(), first);
    std::copy(transform.second.m.begin(), transform.second.m.end(), second);
    std::copy(transform.gains.begin(), transform.gains.end(), gain);
    for (int start = 0; start < width; start += piece) {
        const int count = std::min(piece, width - start);
        float *r = scene[0] + start, *g = scene[1] + start, *b = scene[2] + start;
        make_legal(camera + start * pixel_stride, pixel_stride, count, r, g, b,
                   illegal);
        balance_piece(gain, count, r, g, b);
        if (transform.two_steps)
            product_piece(first, 1.0f, count, r, g, b);
        scene_piece(second, count, r, g, b);
    }
}

void copy_camera(const float* scene, std::ptrdiff_t pixel_stride, int width,
                 float exposure, float* const camera[3], Illegal& illegal)
{
    make_legal(scene, pixel_stride, width, camera[0], camera[1], camera[2], illegal);
    expose(exposure, width, camera[0], camera[1], camera[2]);
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Counter-based random numbers: a draw is a pure function of key and site.
#pragma once

#include "cg2raw/types.h"

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace cg2raw {

/// Philox 4x32-10: four words of a counter under a key.
/// Source: Salmon et al., Parallel Random Numbers: As Easy as 1, 2, 3, SC 2011.
std::array<std::uint32_t, 4> philox_words(const std::array<std::uint32_t, 4>& counter,
                                          const std::array<std::uint32_t, 2>& key);

/// One stream of random numbers: that of (seed, purpose, frame).
class Rng {
public:
    Rng(std::uint64_t seed, std::string_view purpose, std::int64_t frame = 0);

    /// Another stream of the same key and frame, independent of this one.
    Rng other(std::string_view purpose) const;
    /// The stream of the same purpose that every seed and frame share: of a sensor's
    /// fixed pattern, beside what is drawn anew.
    Rng fixed() const;
    /// A stream whose normals are correlated with the next of their row: an
    /// autoregressive process of order 1, of variance 1. |coefficient| <= 0.5. All else
    /// of it is drawn as before. Source: G. E. P. Box, G. M. Jenkins, Time Series
    /// Analysis, 1970, section 3.2.
    Rng correlated(double coefficient) const;

    /// Standard normals, float32, of the sites (row, col) ... (row, col + count - 1);
    /// the same for a site whichever row piece it is asked in, on every machine.
    void normals(Site at, int count, float* out) const;
    /// Uniforms in (0, 1), 52 bits, of the same sites; independent of their normals.
    void uniforms(Site at, int count, double* out) const;
    /// The n-th uniform in (0, 1), float64; for parameters, not for pixels.
    double uniform(std::uint32_t n) const;
    /// The n-th standard normal, float64; uses uniforms 2n and 2n + 1.
    double normal(std::uint32_t n) const;

private:
    void independent_normals(Site at, int count, float* out) const;

    std::uint64_t m_key;
    std::uint64_t m_fixed_key; ///< without the seed
    std::uint64_t m_frame;
    std::vector<float> m_weights; ///< of a normal and of those before it in its row
};

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What darks and flats say, as small arrays of sums: an analysis of variance of
/// groups of frames that repeat each other.
///
/// Each plane of the CFA's repeat is split into orthogonal parts: its level, smooth
/// rows and columns (polynomials of degree 1 to 3), slow ones (4 to 11), fast ones (the
/// rest of the row and column means), a field (products of polynomials of degree 1 to
/// 5) and pixel, which is all that is left. The bases are orthonormal, so that sums of
/// squares split by Parseval. Samples are integers, whose sums in double are exact, and
/// strips are added in order: any number of threads gives the same.
#pragma once

#include "cg2raw/frame_parts.h"
#include "cg2raw/parallel.h"
#include "cg2raw/types.h"

#include <array>
#include <cstdint>
#include <vector>

namespace cg2raw {

inline constexpr std::size_t statistics_blocks = 8; ///< along each side of a plane
inline constexpr std::size_t statistics_bins = 512; ///< of the histogram of residuals
inline constexpr int statistics_bins_per_sigma = 32;
inline constexpr float noisy_sigmas = 4.0F; ///< of a pair: two in 30,000 normal ones
/// Rows and columns from a sample of the mosaic to its neighbour.
inline constexpr std::array<std::array<int, 2>, 6> statistics_lags {
    { { 0, 1 }, { 1, 0 }, { 0, 2 }, { 2, 0 }, { 1, 1 }, { 2, 2 } }
};

/// How many samples have each of the 65,536 codes, by planes of the CFA's repeat.
using CodeCounts = std::vector<std::vector<std::uint32_t>>;
/// @p excluded: 1 for samples that do not count, row by row; none if it is null.
CodeCounts code_counts(const Plane<const std::uint16_t>& frame, int side,
                       const std::uint8_t* excluded, const ParallelFor& parallel);

/// Of the frames of a group, in one plane.
struct PlaneOfGroup {
    double base = 0.0; ///< DN, close to the level
    PlaneSums mean; ///< of the mean image less base, whose masked samples are filled
    std::vector<double> levels; ///< of each frame, DN
    PartSquares scatter {}; ///< of the frames about their mean, DN^2
    double power = 0.0; ///< of pixel in (a - b) / sqrt(2), sum over pairs, DN^2
    double fourth
        = 0.0; ///< their mean fourth power over their variance's square, likewise
    std::array<std::int64_t, statistics_bins> residuals {}; ///< absolute, standardised
    std::array<double, statistics_blocks * statistics_blocks> noise {}; ///< by block
    /// Of the mask's samples: of the mean image, less what stands in its place, DN; and
    /// squares of the pairs' residuals, sums over pairs, DN^2.
    std::vector<double> masked, masked_noise;
};

/// Frames of one kind, exposure and light, by planes: the rows of the repeat in turn.
struct GroupSums {
    int frames = 0, pairs = 0;
    /// Of each frame: how many samples it has alone, far above all others and far
    /// below, where the others are as their surroundings. Counted as frames are
    /// measured.
    std::vector<std::array<std::int64_t, 2>> transients;
    std::vector<PlaneOfGroup> planes;
    /// Sums of products of standardised residuals with those of neighbours.
    std::array<double, statistics_lags.size()> lags {};
    /// By rows of the mosaic, a bit for each sample: whether its residual is beyond
    /// noisy_sigmas in a pair, of samples that are not masked.
    std::vector<std::uint64_t> noisy;
};

/// Goes over all frames twice: look() at all, group by group, mask(), measure() all.
class FrameStatistics {
public:
    /// @p side: samples along the CFA's repeat, 1 without a CFA. @p step: DN between
    /// codes. Throws Error.
    FrameStatistics(Size size, int side, int groups, int step = 1);

    /// Samples that are not 0 are masked: before the first look they count in nothing,
    /// after all of them in the codes alone. Throws Error.
    void exclude(const Plane<const std::uint8_t>& samples);
    /// The first look at a frame. Groups are looked at one after the other. Returns
    /// what codes it has. Throws Error.
    CodeCounts look(int group, const Plane<const std::uint16_t>& frame,
                    const ParallelFor& parallel);
    /// After the first look at all: finds the samples that the parts do not describe,
    /// beyond 8 sigma in the mean of any group or in any frame of several, and lines
    /// beyond 10. Throws Error where nothing is left.
    void mask(const ParallelFor& parallel);
    /// A frame again, or two that are in no other pair: then their difference, too.
    /// Throws Error, for a frame of another size, too.
    void measure(int group, const Plane<const std::uint16_t>& frame,
                 const Plane<const std::uint16_t>* other, const ParallelFor& parallel);

    Size size() const { return m_size; }
    const std::vector<PlaneParts>& planes() const { return m_planes; }
    const std::vector<PlaneMask>& masks() const { return m_masks; }
    const std::vector<GroupSums>& groups() const { return m_groups; }
    /// How many products are in the sums of lags of one pair.
    std::array<double, statistics_lags.size()> lag_counts() const;
    /// Inner products of the groups' mean images less their levels, DN^2: by plane, row
    /// after row.
    std::vector<std::vector<double>> products(const ParallelFor& parallel) const;
    /// How many samples are noisy in both of two groups, row after row.
    std::vector<std::int64_t> overlaps() const;
    /// The mean image of a group, masked samples as they are, transients left out.
    void mean(int group, const Plane<float>& to) const;

private:
    /// A sample that one frame has alone: the first with this value.
    struct Transient {
        std::uint32_t at;
        std::int16_t own; ///< DN, less the frame's level
        bool is_above;
    };
    /// What the first look at a group's frames leaves.
    struct Look {
        std::vector<std::uint32_t> sum;
        std::vector<double> base; ///< DN, by plane
        std::vector<std::vector<double>>
            filled; ///< masked samples, less base, by plane
        std::vector<std::vector<std::int32_t>> levels; ///< DN, rounded, by frame, plane
        std::vector<Transient> transients; ///< that no frame was found to have
    };

    /// Sums of one plane of a frame whose masked samples are filled in, less base.
    struct Filled {
        PlaneSums sums;
        std::vector<double> masked;
    };

    void check_size(const Plane<const std::uint16_t>& frame) const;
    void finish_look(const ParallelFor& parallel);
    std::vector<std::uint8_t> outliers(int group, const ParallelFor& parallel);
    void add_frame(int group, const Plane<const std::uint16_t>& frame,
                   const std::vector<Filled>& planes);
    void add_transients(int group, const Plane<const std::uint16_t>& frame);
    std::vector<Filled> filled_sums(int group, const Plane<const std::uint16_t>& frame,
                                    const ParallelFor& parallel) const;
    void add_pair(int group, const Plane<const std::uint16_t>& a,
                  const Plane<const std::uint16_t>& b,
                  const std::vector<Filled>& filled_a,
                  const std::vector<Filled>& filled_b, const ParallelFor& parallel);
    Plane<const std::uint32_t> sum_of(int group) const;

    Size m_size;
    int m_side, m_step;
    int m_current = 0; ///< group that is looked at
    std::vector<PlaneParts> m_planes;
    std::vector<PlaneMask> m_masks;
    /// Of the mosaic: in no code, in no part, and masked.
    std::vector<std::uint8_t> m_uncounted, m_excluded, m_marked;
    std::vector<std::int16_t> m_highest, m_lowest; ///< of this group, less levels
    std::vector<Look> m_looks;
    std::vector<GroupSums> m_groups;
};

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file For effects that work piece by piece on a mosaic whose CFA sites differ.
#pragma once

#include "cg2raw/effect.h"

#include <algorithm>
#include <cassert>

namespace cg2raw {

/// Pixels of a row that are worked on together; they stay in the first-level cache.
constexpr int most_in_piece = 256;

/// A piece of a row of a Signal.
struct SitePiece {
    Site at; ///< of its first pixel, in the active area
    int count;
    const float* mean;
    float* noise;
    const double* value; ///< each pixel's, that of its CFA site
};

/// Calls work(SitePiece) for all of the mosaic. The first cfa.sites() of @p values are
/// those of the CFA's sites, in raster order.
template <class Work>
void each_piece_of_sites(const Signal& signal, const Values& values, const Work& work)
{
    const CfaPattern& cfa = signal.exposure.cfa;
    assert(values.size() >= std::size_t(cfa.sites()));
    const int width = signal.mean[0].width;
    double value[most_in_piece];
    for (int row = 0; row < signal.mean[0].height; ++row) {
        const int site_row = (signal.origin.row + row) % cfa.height;
        const double* const of_row
            = values.data() + std::ptrdiff_t(site_row) * cfa.width;
        for (int col = 0; col < width; col += most_in_piece) {
            const Site at { signal.origin.row + row, signal.origin.col + col };
            const int count = std::min(most_in_piece, width - col);
            for (int i = 0, site = at.col % cfa.width; i < count; ++i) {
                value[i] = of_row[site];
                site = site + 1 == cfa.width ? 0 : site + 1;
            }
            work(SitePiece { at, count, signal.mean[0].row(row) + col,
                             signal.noise.row(row) + col, value });
        }
    }
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file For effects whose values differ between the sites of a CFA.
#pragma once

#include "cg2raw/effect.h"

#include <algorithm>
#include <cassert>

namespace cg2raw {

/// One parameter per site of a Bayer CFA: name_00, name_01, name_10, name_11 (row,
/// col); of a monochrome sensor name_00 alone. A larger CFA has no such parameters; a
/// noise table gives it a value per site.
inline std::vector<Parameter> per_site(const std::string& name, const std::string& unit,
                                       double min, double max,
                                       const std::string& meaning)
{
    std::vector<Parameter> parameters;
    for (const char* site : { "00", "01", "10", "11" })
        parameters.push_back(
            { name + "_" + site, unit, min, max, 0.0, meaning,
              parameters.empty() ? CfaRepeat::first_site : CfaRepeat::other_site });
    return parameters;
}

/// Calls row(mean, variance, pair, width) for pieces of rows; pair[0] and pair[1] are
/// the values of a piece's even and odd columns, counted from its first pixel. A piece
/// is a whole row of a Bayer CFA or of none, else two columns, or the last of an odd
/// row. @p values has one per site.
template <class Row>
void each_row_of_sites(Signal& signal, const Values& values, const Row& row)
{
    constexpr int most_pairs = 3; // of a 6x6 repeat
    const CfaPattern& cfa = signal.exposure.cfa;
    assert(values.size() >= std::size_t(cfa.sites()));
    assert((cfa.is_mono() || cfa.width % 2 == 0) && cfa.width <= 2 * most_pairs);
    const int pairs = std::max(1, cfa.width / 2), width = signal.variance.width;
    for (int r = 0; r < signal.variance.height; ++r) {
        const int site_row = (signal.origin.row + r) % cfa.height;
        const double* const of_row
            = values.data() + std::ptrdiff_t(site_row) * cfa.width;
        float pair[most_pairs][2];
        for (int col = 0; col < 2 * pairs; ++col)
            pair[col / 2][col % 2]
                = float(of_row[(signal.origin.col + col) % cfa.width]);
        float* const mean = signal.mean[0].row(r);
        float* const variance = signal.variance.row(r);
        if (pairs == 1) {
            row(mean, variance, pair[0], width);
            continue;
        }
        int next = 0;
        for (int col = 0; col + 1 < width; col += 2) {
            row(mean + col, variance + col, pair[next], 2);
            next = next + 1 < pairs ? next + 1 : 0;
        }
        if (width % 2)
            row(mean + width - 1, variance + width - 1, pair[next], 1);
    }
}

/// Adds the variance of photons, however they are drawn: slope times signal, with each
/// site's slope.
inline void add_photon_variance(Signal& signal, const Values& slopes)
{
    each_row_of_sites(
        signal, slopes,
        [](const float* mean, float* variance, const float* slope, int width) {
            for (int col = 0; col < width; ++col)
                variance[col] += slope[col & 1] * std::max(mean[col], 0.0f);
        });
}

/// Adds each site's variance, whatever the signal.
inline void add_site_variance(Signal& signal, const Values& variances)
{
    each_row_of_sites(
        signal, variances,
        [](const float*, float* variance, const float* offset, int width) {
            for (int col = 0; col < width; ++col)
                variance[col] += offset[col & 1];
        });
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file For effects whose parameters differ between the four sites of a Bayer CFA.
#pragma once

#include "cg2raw/effect.h"

namespace cg2raw {

/// One parameter per site of a Bayer CFA: name_00, name_01, name_10, name_11 (row,
/// col).
inline std::vector<Parameter> per_site(const std::string& name, const std::string& unit,
                                       double min, double max,
                                       const std::string& meaning)
{
    std::vector<Parameter> parameters;
    for (const char* site : { "00", "01", "10", "11" })
        parameters.push_back({ name + "_" + site, unit, min, max, 0.0, meaning });
    return parameters;
}

/// Calls row(mean, variance, values of the row's even and odd columns, width) for every
/// row; even and odd count from the row's first pixel.
template <class Row>
void each_row_of_sites(Signal& signal, const Values& values, const Row& row)
{
    for (int r = 0; r < signal.variance.height; ++r) {
        const std::size_t first = std::size_t((signal.origin.row + r) % 2 * 2);
        const std::size_t odd = std::size_t(signal.origin.col % 2);
        const float pair[2]
            = { float(values[first + odd]), float(values[first + 1 - odd]) };
        row(signal.mean[0].row(r), signal.variance.row(r), pair, signal.variance.width);
    }
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file A black level that is not the stated one, at each site of the CFA. As all of
/// the read-out it does not fall on what was clipped.
#include "cg2raw/effect.h"

#include "site_rows.h"

namespace cg2raw::effects {
namespace {

void predict(Signal& signal, const Values& values)
{
    const CfaPattern& cfa = signal.exposure.cfa;
    for (int row = 0; row < signal.noise.height; ++row) {
        const int site_row = (signal.origin.row + row) % cfa.height;
        const double* const of_row
            = values.data() + std::ptrdiff_t(site_row) * cfa.width;
        const float pair[2] = { float(of_row[signal.origin.col % cfa.width]),
                                float(of_row[(signal.origin.col + 1) % cfa.width]) };
        float* const noise = signal.noise.row(row);
        for (int col = 0; col < signal.noise.width; ++col)
            noise[col] += pair[col & 1];
    }
}

void draw(Signal& signal, const Values& values, const Rng&) { predict(signal, values); }

} // namespace

Effect black_level()
{
    return { "black_level",
             Stage::readout,
             Pattern::none,
             per_site("offset", "1", -0.2, 0.2, "excess of black at a CFA site"),
             "a black level other than the stated one",
             "DNG specification 1.6, BlackLevel",
             predict,
             draw };
}

} // namespace cg2raw::effects

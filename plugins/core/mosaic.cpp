// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/mosaic.h"

#include "multiversion.h"

namespace cg2raw {
namespace {

CG2RAW_MULTIVERSION void alternate(const float* even, const float* odd, int width,
                                   float* raw)
{
    for (int col = 0; col + 1 < width; col += 2) {
        raw[col] = even[col];
        raw[col + 1] = odd[col + 1];
    }
    if (width % 2)
        raw[width - 1] = even[width - 1];
}

} // namespace

void mosaic(const float* const camera[3], const CfaPattern& cfa, Site at, int width,
            float* raw)
{
    if (cfa.width == 2) {
        alternate(camera[cfa.color(at)], camera[cfa.color({ at.row, at.col + 1 })],
                  width, raw);
        return;
    }
    for (int phase = 0; phase < cfa.width; ++phase) {
        const float* const from = camera[cfa.color({ at.row, at.col + phase })];
        for (int col = phase; col < width; col += cfa.width)
            raw[col] = from[col];
    }
}

} // namespace cg2raw

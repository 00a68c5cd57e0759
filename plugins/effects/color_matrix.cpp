// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file A sensor whose colours differ from its matrices': in balanced camera RGB
/// each channel takes differences of the others to itself, so that greys stay.
#include "cg2raw/effect.h"

namespace cg2raw::effects {
namespace {

/// W (I + E) W^-1 with W = diag(neutral); rows of E sum to 0.
void predict(Signal& signal, const Values& values)
{
    Vec3 white = signal.exposure.neutral;
    const auto mix = [&](std::size_t to, std::size_t from, double value) {
        return float(value * white[to] / white[from]);
    };
    const float rg = mix(0, 1, values[0]), rb = mix(0, 2, values[1]);
    const float gr = mix(1, 0, values[2]), gb = mix(1, 2, values[3]);
    const float br = mix(2, 0, values[4]), bg = mix(2, 1, values[5]);
    const float rr = float(values[0] + values[1]), gg = float(values[2] + values[3]),
                bb = float(values[4] + values[5]);
    for (int row = 0; row < signal.mean[0].height; ++row) {
        float* const red = signal.mean[0].row(row);
        float* const green = signal.mean[1].row(row);
        float* const blue = signal.mean[2].row(row);
        for (int col = 0; col < signal.mean[0].width; ++col) {
            const float r = red[col], g = green[col], b = blue[col];
            red[col] = r + (rg * g + rb * b - rr * r);
            green[col] = g + (gr * r + gb * b - gg * g);
            blue[col] = b + (br * r + bg * g - bb * b);
        }
    }
}

} // namespace

Effect color_matrix()
{
    constexpr std::pair<char, const char*> colors[]
        = { { 'r', "red" }, { 'g', "green" }, { 'b', "blue" } };
    std::vector<Parameter> parameters;
    for (const auto& [to, to_word] : colors)
        for (const auto& [from, from_word] : colors) {
            if (to == from)
                continue;
            parameters.push_back(
                { { to, from }, "1", -1.0, 1.0, 0.0, "", CfaRepeat::colors });
            parameters.back().meaning = to_word + std::string(": share of (")
                + from_word + " - " + to_word + ") added, in balanced camera RGB";
        }
    return { "color_matrix",
             Stage::color,
             Pattern::none,
             parameters,
             "spectral sensitivities other than those of the colour matrices; greys "
             "stay",
             "G. D. Finlayson, M. S. Drew, CIC 5, 1997 (white-point preserving)",
             predict };
}

} // namespace cg2raw::effects

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "transform_uplift.h"

#include "illuminant_spectrum.h"
#include "transform_uplift_basis.h"

#include <numeric>

namespace cg2raw {

UpliftMatrix balanced_from_terms(const SpectralSensitivities& sensitivities,
                                 const Spectrum& light)
{
    Spectrum basis { table_wavelengths(), {} };
    const std::vector<double> nodes = merged(
        merged(sensitivities.wavelengths, light.wavelengths), basis.wavelengths);
    response(sensitivities, light); // throws where a channel sees nothing
    UpliftMatrix result {};
    for (std::size_t term = 0; term < uplift_basis.size(); ++term) {
        basis.values.assign(uplift_basis[term].begin(), uplift_basis[term].end());
        for (std::size_t c = 0; c < 3; ++c)
            result[c][term] = integral(
                [&](double nm) {
                    return sensitivities.at(nm)[c] * light.at(nm) * basis.at(nm);
                },
                nodes, visible_from, visible_to);
    }
    for (auto& row : result) {
        const double white = std::accumulate(row.begin(), row.end(), 0.0);
        for (double& value : row)
            value /= white;
    }
    return result;
}

} // namespace cg2raw

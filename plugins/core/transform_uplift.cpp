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
    const std::vector<double> table = table_wavelengths();
    const std::vector<double> nodes
        = merged(merged(sensitivities.wavelengths, light.wavelengths), table);
    std::vector<Spectrum> basis;
    for (const auto& values : uplift_basis)
        basis.push_back({ table, { values.begin(), values.end() } });
    response(sensitivities, light); // throws where a channel sees nothing
    UpliftMatrix result {};
    for (const auto& [nm, weight] : quadrature(nodes, visible_from, visible_to)) {
        const double power = weight * light.at(nm);
        const Vec3 sensitivity = sensitivities.at(nm);
        for (std::size_t term = 0; term < basis.size(); ++term)
            for (std::size_t c = 0; c < 3; ++c)
                result[c][term] += power * sensitivity[c] * basis[term].at(nm);
    }
    for (auto& row : result) {
        const double white = std::accumulate(row.begin(), row.end(), 0.0);
        for (double& value : row)
            value /= white;
    }
    return result;
}

} // namespace cg2raw

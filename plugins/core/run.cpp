// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/run.h"

#include "cg2raw/random.h"
#include "text.h"

namespace cg2raw {

NoiseModel noise_model_from_name(std::string_view name)
{
    if (name == "gaussian")
        return NoiseModel::gaussian;
    if (name == "physical")
        return NoiseModel::physical;
    throw Error("noise \"" + std::string(name) + "\" must be gaussian or physical");
}

const char* name_of(NoiseModel model)
{
    return model == NoiseModel::gaussian ? "gaussian" : "physical";
}

std::uint64_t noise_seed(const Run& run)
{
    if (!run.bracket)
        return run.seed;
    const Rng rng(run.seed, "bracket/" + number(*run.bracket));
    return std::uint64_t(rng.uniform(0) * 4503599627370496.0); // 2^52, all its bits
}

} // namespace cg2raw

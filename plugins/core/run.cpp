// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/run.h"

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

} // namespace cg2raw

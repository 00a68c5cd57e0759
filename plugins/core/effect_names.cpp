// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "effect_names.h"

#include "cg2raw/effect.h"

#include <string>
#include <utility>

namespace cg2raw {

std::string_view current_effect_name(std::string_view name)
{
    constexpr std::pair<std::string_view, std::string_view> renamed[] = {
        { "early_clipping", "full_well" },
        { "photon_statistics", "poisson_shot_noise" },
        { "column_noise", "column_fixed_pattern" },
    };
    for (const auto& [former, current] : renamed)
        if (name == former)
            return current;
    return name;
}

void check_effect_name(std::string_view name)
{
    const std::string_view current = current_effect_name(name);
    if (name != current)
        throw Error("effect \"" + std::string(name) + "\" is called \""
                    + std::string(current) + "\" since version 0.1: use that name");
}

} // namespace cg2raw

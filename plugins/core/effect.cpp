// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/effect.h"

#include "effect_list.h"
#include "effect_names.h"
#include "text.h"

#include <algorithm>
#include <tuple>

namespace cg2raw {

const char* name_of(Stage stage)
{
    constexpr const char* names[]
        = { "color",      "optics",  "pixel", "response",  "noise",
            "saturation", "readout", "adc",   "processing" };
    return names[std::size_t(stage)];
}

const char* name_of(Pattern pattern)
{
    constexpr const char* names[] = { "none", "fixed", "temporal" };
    return names[std::size_t(pattern)];
}

const std::vector<Effect>& all_effects()
{
    static const std::vector<Effect> sorted = [] {
        auto all = defined_effects();
        std::sort(all.begin(), all.end(), [](const Effect& a, const Effect& b) {
            return std::tie(a.stage, a.name) < std::tie(b.stage, b.name);
        });
        return all;
    }();
    return sorted;
}

const Effect& effect(std::string_view name)
{
    check_effect_name(name);
    std::vector<std::string> names;
    for (const Effect& candidate : all_effects()) {
        if (candidate.name == name)
            return candidate;
        names.push_back(candidate.name);
    }
    throw Error("effect \"" + std::string(name)
                + "\" is unknown; known: " + joined(names));
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "targets.h"

namespace cg2raw::test {

bool fuzz_profile(std::string_view bytes)
{
    SensorProfile profile {};
    const auto parse = [&] { profile = parse_profile(bytes, "fuzz.json"); };
    if (!bounded(parse, bytes.size(), profile_memory, "fuzz.json"))
        return false;
    use(profile);
    return true;
}

} // namespace cg2raw::test

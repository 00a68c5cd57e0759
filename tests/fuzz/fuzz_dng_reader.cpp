// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "reader/metadata_parts.h"
#include "targets.h"

#include <sstream>

namespace cg2raw::test {

bool fuzz_dng_reader(std::string_view bytes)
{
    const std::string name = "fuzz.dng";
    std::istringstream stream { std::string(bytes) };
    std::vector<DngMetadata> files(1);
    SensorProfile profile {};
    const auto limited = [&](const std::function<void()>& step) {
        return bounded(step, bytes.size(), dng_memory, name);
    };
    if (!limited([&] { files[0] = read_dng_stream(stream, name); }))
        return false;
    if (limited([&] { profile = profile_from_dng(files[0]); }))
        use(profile);
    files.push_back(files[0]); // of two files, other notes; a file without a neutral
    if (limited([&] { profile = profile_from_dngs(files, "fuzz").profile; }))
        use(profile);
    return true;
}

} // namespace cg2raw::test

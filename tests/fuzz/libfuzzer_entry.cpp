// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file libFuzzer's door to the target that the build names, CG2RAW_FUZZ_TARGET.
#include "targets.h"

#include <cstdio>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    try {
        cg2raw::test::CG2RAW_FUZZ_TARGET({ reinterpret_cast<const char*>(data), size });
    } catch (const std::exception& error) {
        std::fprintf(stderr, "FINDING: %s\n", error.what());
        std::abort();
    }
    return 0;
}

extern "C" int LLVMFuzzerInitialize(int*, char***)
{
    std::atexit([] {
        std::fprintf(stderr, "MEMORY: at most %.3f of the bound\n",
                     cg2raw::test::most_of_bound());
    });
    return 0;
}

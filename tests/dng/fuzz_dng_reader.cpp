// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file libFuzzer's door to the DNG reader; in no default build. With clang:
///   clang++ -std=c++17 -O1 -g -fsanitize=fuzzer,address,undefined -Iplugins/include
///     -Iplugins/dng -Iplugins/core tests/dng/fuzz_dng_reader.cpp
///     plugins/dng/dng_reader*.cpp plugins/dng/tiff_reader*.cpp
///     plugins/effects/*.cpp and the core's color, effect, illuminant*, noise_table,
///     profile*, sampling, random, raw_space, temperature, text .cpp
///     -Ibuild/system/plugins (effect_list.h) -ldl -o fuzz_dng_reader
///   ./fuzz_dng_reader -max_len=8192 -malloc_limit_mb=4 -timeout=2 CORPUS
#include "dng_reader_tags.h"

#include <cstdlib>
#include <sstream>

using namespace cg2raw;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    std::istringstream stream(std::string(reinterpret_cast<const char*>(data), size));
    try {
        const SensorProfile profile
            = profile_from_dng(read_dng_stream(stream, "fuzz.dng"));
        // What was accepted must be a profile that reads back the same.
        const std::string json = to_json(profile);
        if (to_json(parse_profile(json, "fuzz.dng")) != json)
            std::abort();
    } catch (const Error& error) {
        if (std::string(error.what()).rfind("fuzz.dng: ", 0) != 0)
            std::abort();
    }
    return 0;
}

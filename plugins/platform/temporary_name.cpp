// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "platform/temporary_name.h"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <random>

namespace cg2raw {
namespace {

/// From the system; where that has none left to give, such as a descriptor for
/// /dev/urandom, from the time, and then only different from the last one.
std::uint64_t random_bits()
{
    try {
        std::random_device device;
        return std::uint64_t(device()) << 32 | device();
    } catch (const std::exception&) {
        static std::atomic<std::uint64_t> count { 0 };
        const auto now = std::chrono::steady_clock::now().time_since_epoch().count();
        return (std::uint64_t(now) + ++count) * 0x9e3779b97f4a7c15u; // odd: one to one
    }
}

} // namespace

std::string temporary_ending()
{
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016llx",
                  static_cast<unsigned long long>(random_bits()));
    return std::string(".cg2raw-") + digits;
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file How much memory a piece of code takes. A program that links counted_memory.cpp
/// counts every operator new.
#pragma once

#include <cstddef>

namespace cg2raw::test {

/// Memory of this thread since the meter was made, in bytes. One at a time per thread.
class MemoryMeter {
public:
    MemoryMeter();
    /// Most that was held at once, beyond what was held before.
    std::size_t most() const;
    /// Largest single request.
    std::size_t largest() const;

private:
    std::ptrdiff_t m_before;
};

} // namespace cg2raw::test

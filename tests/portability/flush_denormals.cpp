// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Numbers too small for a normal float count as 0, as where a host has set the
/// processor so: Embree asks for it, and libraries built with -ffast-math do it.
#include <xmmintrin.h>

namespace {

struct FlushDenormals {
    FlushDenormals()
    {
        constexpr unsigned flush_to_zero = 0x8000, denormals_are_zero = 0x0040;
        _mm_setcsr(_mm_getcsr() | flush_to_zero | denormals_are_zero);
    }
};

const FlushDenormals in_this_program; // and in the threads that it starts

} // namespace

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Hot loops are compiled twice, for AVX2 and for any x86-64, and chosen at load.
/// Both give the same bits: no fused multiply-add, no reordering (see build flags).
#pragma once

// Clang defines __GNUC__, too, but (as of 18) refuses target_clones on templates.
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__clang__)               \
    && !defined(__SANITIZE_ADDRESS__) && !defined(CG2RAW_SANITIZED)
#define CG2RAW_MULTIVERSION __attribute__((target_clones("avx2", "default")))
#else
#define CG2RAW_MULTIVERSION
#endif

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Tasks on several cores: the caller says which.
#pragma once

#include <functional>

namespace cg2raw {

/// Calls task(0) ... task(count - 1), in any order, on any threads, and returns when
/// all are done.
using ParallelFor
    = std::function<void(int count, const std::function<void(int)>& task)>;
/// As many std::threads as asked; 0: one per core.
ParallelFor parallel_threads(int threads);

inline constexpr int strip_rows = 64; ///< of each strip but the last
inline int strip_count(int height) { return (height + strip_rows - 1) / strip_rows; }

/// Calls work for strips of rows that together are all @p height of them.
void each_strip(int height, const ParallelFor& parallel,
                const std::function<void(int first, int count)>& work);

} // namespace cg2raw

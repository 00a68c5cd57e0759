// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The host's threads, for our tasks.
#pragma once

#include <functional>

namespace cg2raw {

/// A ParallelFor on OpenImageIO's thread pool. That lets no exception through, so the
/// first one is kept, and thrown when all tasks are done.
void in_thread_pool(int count, const std::function<void(int)>& task);

} // namespace cg2raw

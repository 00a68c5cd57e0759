// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Each task runs once, on as many threads as there may be.
#include "cg2raw/parallel.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <vector>

namespace cg2raw {
namespace {

bool each_task_runs_once(int threads)
{
    std::vector<std::atomic<int>> runs(200);
    parallel_threads(threads)(int(runs.size()), [&](int task) { ++runs[task]; });
    return std::all_of(runs.begin(), runs.end(), [](const auto& n) { return n == 1; });
}

TEST(ParallelThreads, RunEachTaskOnce)
{
    for (const int threads : { 0, 1, 2, 7, 64, 1000 })
        EXPECT_TRUE(each_task_runs_once(threads)) << threads;
}

TEST(ParallelThreads, DoTheWorkWhereNoMoreCanBeStarted)
{
#ifdef CG2RAW_SANITIZED
    GTEST_SKIP() << "the sanitizers need more address space than this test leaves";
#endif
    const pid_t child = ::fork();
    if (child == 0) {
        const rlimit none { 0, 0 }; // of address space: a new thread has no stack
        ::setrlimit(RLIMIT_AS, &none);
        ::_exit(each_task_runs_once(8) ? 0 : 1);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status);
    EXPECT_EQ(WEXITSTATUS(status), 0);
}

} // namespace
} // namespace cg2raw

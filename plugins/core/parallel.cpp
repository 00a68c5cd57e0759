// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The default way to use several cores.
#include "cg2raw/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace cg2raw {

ParallelFor parallel_threads(int threads)
{
    const int wanted = threads > 0 ? threads : int(std::thread::hardware_concurrency());
    return [wanted](int count, const std::function<void(int)>& task) {
        std::atomic<int> next { 0 };
        std::exception_ptr first_error;
        std::mutex guard;
        const auto work = [&] {
            for (int i = next++; i < count; i = next++) {
                try {
                    task(i);
                } catch (...) {
                    const std::lock_guard lock(guard);
                    if (!first_error)
                        first_error = std::current_exception();
                }
            }
        };
        std::vector<std::thread> helpers;
        for (int i = 1; i < std::min(wanted, count); ++i) {
            try {
                helpers.emplace_back(work);
            } catch (const std::exception&) {
                break; // no more threads, or no memory for one: the others do the work
            }
        }
        work();
        for (std::thread& helper : helpers)
            helper.join();
        if (first_error)
            std::rethrow_exception(first_error);
    };
}

void each_strip(int height, const ParallelFor& parallel,
                const std::function<void(int first, int count)>& work)
{
    parallel(strip_count(height), [&](int strip) {
        const int first = strip * strip_rows;
        work(first, std::min(strip_rows, height - first));
    });
}

} // namespace cg2raw

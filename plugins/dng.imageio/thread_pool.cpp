// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "thread_pool.h"

#include <OpenImageIO/parallel.h>

#include <exception>
#include <mutex>

namespace cg2raw {

void in_thread_pool(int count, const std::function<void(int)>& task)
{
    std::exception_ptr first_error;
    std::mutex guard;
    OIIO::parallel_for(int64_t(0), int64_t(count), [&](int64_t index) {
        try {
            task(int(index));
        } catch (...) {
            const std::lock_guard<std::mutex> lock(guard);
            if (!first_error)
                first_error = std::current_exception();
        }
    });
    if (first_error)
        std::rethrow_exception(first_error);
}

} // namespace cg2raw

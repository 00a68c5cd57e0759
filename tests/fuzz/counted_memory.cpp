// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "counted_memory.h"

#ifdef __APPLE__
#include <malloc/malloc.h>
#else
#include <malloc.h>
#endif

#include <algorithm>
#include <cstdlib>
#include <new>

namespace {

std::size_t size_of(void* memory)
{
#if defined(__APPLE__)
    return ::malloc_size(memory);
#elif defined(_WIN32)
    return ::_msize(memory);
#else
    return ::malloc_usable_size(memory);
#endif
}

thread_local std::ptrdiff_t held = 0, most_held = 0;
thread_local std::size_t largest_request = 0;

void* counted(std::size_t size)
{
    void* const memory = std::malloc(size ? size : 1);
    if (!memory)
        throw std::bad_alloc();
    held += std::ptrdiff_t(size_of(memory));
    most_held = std::max(most_held, held);
    largest_request = std::max(largest_request, size);
    return memory;
}

void* counted_or_null(std::size_t size) noexcept
{
    try {
        return counted(size);
    } catch (const std::bad_alloc&) {
        return nullptr;
    }
}

void uncounted(void* memory)
{
    held -= memory ? std::ptrdiff_t(size_of(memory)) : 0;
    std::free(memory);
}

} // namespace

void* operator new(std::size_t size) { return counted(size); }

void* operator new[](std::size_t size) { return counted(size); }

// std::stable_sort asks this way. Left to the library, a sanitizer's own would answer.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept
{
    return counted_or_null(size);
}

void* operator new[](std::size_t size, const std::nothrow_t&) noexcept
{
    return counted_or_null(size);
}

void operator delete(void* memory) noexcept { uncounted(memory); }

void operator delete[](void* memory) noexcept { uncounted(memory); }

void operator delete(void* memory, std::size_t) noexcept { uncounted(memory); }

void operator delete[](void* memory, std::size_t) noexcept { uncounted(memory); }

namespace cg2raw::test {

MemoryMeter::MemoryMeter()
    : m_before(held)
{
    most_held = held;
    largest_request = 0;
}

std::size_t MemoryMeter::most() const { return std::size_t(most_held - m_before); }

std::size_t MemoryMeter::largest() const { return largest_request; }

} // namespace cg2raw::test

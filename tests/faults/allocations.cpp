// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Memory that injector.h refuses: to our libraries and to libtiff, or to what
/// the C and C++ libraries do for them. Of glibc, whose own functions it calls.
#include "injector.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <new>

#include <dlfcn.h>
#include <execinfo.h>

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
}

namespace {

/// Who asks for memory. Through a runtime, whoever called that asks.
enum class Caller : std::uint64_t { unknown, other, ours, runtime };

bool begins(const char* name, const char* with)
{
    return std::strncmp(name, with, std::strlen(with)) == 0;
}

Caller caller_by_name(const void* address)
{
    Dl_info info;
    if (!dladdr(address, &info) || !info.dli_fname)
        return Caller::other;
    const char* const slash = std::strrchr(info.dli_fname, '/');
    const char* const name = slash ? slash + 1 : info.dli_fname;
    for (const char* ours : { "_core.", "dng.imageio", "libtiff" })
        if (begins(name, ours))
            return Caller::ours;
    for (const char* runtime : { "libc.", "libstdc++", "injector" })
        if (begins(name, runtime))
            return Caller::runtime;
    return Caller::other;
}

/// The same, remembered by page of the code.
Caller caller_at(const void* address)
{
    static std::array<std::atomic<std::uint64_t>, 4096> known {};
    const std::uint64_t page = std::uint64_t(address) >> 12;
    std::atomic<std::uint64_t>& entry = known[page % known.size()];
    const std::uint64_t found = entry.load();
    if (found >> 2 == page && found != 0)
        return Caller(found & 3);
    const Caller caller = caller_by_name(address);
    entry.store(page << 2 | std::uint64_t(caller));
    return caller;
}

bool is_for_us(const void* address)
{
    const Caller first = caller_at(address);
    if (first != Caller::runtime)
        return first == Caller::ours;
    std::array<void*, 12> frames {};
    const int count = backtrace(frames.data(), int(frames.size()));
    for (int i = 1; i < count; ++i)
        if (const Caller caller = caller_at(frames[std::size_t(i)]);
            caller != Caller::runtime)
            return caller == Caller::ours;
    return false;
}

/// Whether memory that the code at @p address asks for is refused.
bool is_refused(const void* address)
{
    static thread_local bool is_asking = false; // what asks may itself need memory
    if (!fault_is_asked("malloc") || is_asking)
        return false;
    is_asking = true;
    const bool refused = is_for_us(address) && fault_strikes();
    is_asking = false;
    if (refused)
        errno = ENOMEM;
    return refused;
}

/// The first backtrace() loads a library.
__attribute__((constructor)) void prepare()
{
    std::array<void*, 2> frames {};
    backtrace(frames.data(), int(frames.size()));
}

void* found_or_thrown(void* memory)
{
    if (!memory)
        throw std::bad_alloc();
    return memory;
}

} // namespace

#define ADDRESS __builtin_extract_return_addr(__builtin_return_address(0))
#define UNLESS_REFUSED(memory) (is_refused(ADDRESS) ? nullptr : (memory))

extern "C" {
void* malloc(std::size_t size) { return UNLESS_REFUSED(__libc_malloc(size)); }

void* calloc(std::size_t count, std::size_t size)
{
    return UNLESS_REFUSED(__libc_calloc(count, size));
}

void* realloc(void* memory, std::size_t size)
{
    return UNLESS_REFUSED(__libc_realloc(memory, size));
}

void* aligned_alloc(std::size_t alignment, std::size_t size)
{
    return UNLESS_REFUSED(__libc_memalign(alignment, size));
}
}

void* operator new(std::size_t size)
{
    return found_or_thrown(UNLESS_REFUSED(__libc_malloc(size ? size : 1)));
}

void* operator new[](std::size_t size)
{
    return found_or_thrown(UNLESS_REFUSED(__libc_malloc(size ? size : 1)));
}

void* operator new(std::size_t size, std::align_val_t alignment)
{
    return found_or_thrown(
        UNLESS_REFUSED(__libc_memalign(std::size_t(alignment), size)));
}

void* operator new[](std::size_t size, std::align_val_t alignment)
{
    return found_or_thrown(
        UNLESS_REFUSED(__libc_memalign(std::size_t(alignment), size)));
}

void* operator new(std::size_t size, const std::nothrow_t&) noexcept
{
    return UNLESS_REFUSED(__libc_malloc(size ? size : 1));
}

void* operator new[](std::size_t size, const std::nothrow_t&) noexcept
{
    return UNLESS_REFUSED(__libc_malloc(size ? size : 1));
}

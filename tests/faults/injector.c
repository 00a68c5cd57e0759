/* SPDX-License-Identifier: Apache-2.0
 * Copyright Contributors to the cg2raw Project.
 *
 * LD_PRELOAD: makes a system call on files of one folder fail. Environment:
 *   FAULT_UNDER   the folder; files elsewhere, pipes and sockets are left alone
 *   FAULT_CALL    open, write, pwrite, fsync, close, link, rename or fchmod
 *   FAULT_ERRNO   what it fails with
 *   FAULT_NTH     which of these calls in a process fails, from 1 on
 *   FAULT_STICKY  1: and all after it
 *   FAULT_NO_TMPFILE  1: the file system knows no files without a name
 *   FAULT_LOG     a file that gets a byte when a call was made to fail
 *   FAULT_CASE    any text; calls are counted anew when it changes
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

static int calls;
static char counted_case[64];

static int is_set(const char* name)
{
    const char* const value = getenv(name);
    return value && *value == '1';
}

static int is_under(const char* path)
{
    const char* const folder = getenv("FAULT_UNDER");
    return folder && strncmp(path, folder, strlen(folder)) == 0;
}

static int is_file_under(int file)
{
    char link[64], path[PATH_MAX + 1];
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    const ssize_t size = readlink(link, path, PATH_MAX);
    if (size < 0)
        return 0;
    path[size] = '\0';
    return is_under(path);
}

static void log_it(void)
{
    static int (*real_open)(const char*, int, ...);
    static ssize_t (*real_write)(int, const void*, size_t);
    static int (*real_close)(int);
    if (!real_open) {
        real_open = dlsym(RTLD_NEXT, "open");
        real_write = dlsym(RTLD_NEXT, "write");
        real_close = dlsym(RTLD_NEXT, "close");
    }
    const char* const path = getenv("FAULT_LOG");
    const int file = path ? real_open(path, O_WRONLY | O_CREAT | O_APPEND, 0600) : -1;
    if (file >= 0) {
        if (real_write(file, "x", 1) != 1)
            abort();
        real_close(file);
    }
}

/* Whether this call is to fail; sets errno then. */
static int fails(const char* call)
{
    const char* const asked = getenv("FAULT_CALL");
    if (!asked || strcmp(asked, call) != 0)
        return 0;
    const char* const now = getenv("FAULT_CASE");
    if (now && strncmp(now, counted_case, sizeof counted_case - 1) != 0) {
        strncpy(counted_case, now, sizeof counted_case - 1);
        calls = 0;
    }
    const int nth = getenv("FAULT_NTH") ? atoi(getenv("FAULT_NTH")) : 1;
    const int count = __sync_add_and_fetch(&calls, 1);
    if (count < nth || (count > nth && !is_set("FAULT_STICKY")))
        return 0;
    log_it();
    errno = atoi(getenv("FAULT_ERRNO"));
    return 1;
}

#define REAL(name) \
    static __typeof__(&name) real; \
    if (!real) \
        real = (__typeof__(&name))dlsym(RTLD_NEXT, #name)

static int refused(const char* path, int flags)
{
#ifdef O_TMPFILE
    if ((flags & O_TMPFILE) == O_TMPFILE && is_set("FAULT_NO_TMPFILE") && is_under(path)) {
        errno = EOPNOTSUPP;
        return 1;
    }
#endif
    return (flags & O_ACCMODE) != O_RDONLY && is_under(path) && fails("open");
}

static mode_t mode_of(int flags, va_list rest)
{
    const int makes = (flags & O_CREAT) || (flags & O_TMPFILE) == O_TMPFILE;
    return makes ? va_arg(rest, mode_t) : 0;
}

int open(const char* path, int flags, ...)
{
    REAL(open);
    va_list rest;
    va_start(rest, flags);
    const mode_t mode = mode_of(flags, rest);
    va_end(rest);
    return refused(path, flags) ? -1 : real(path, flags, mode);
}

int open64(const char* path, int flags, ...)
{
    REAL(open64);
    va_list rest;
    va_start(rest, flags);
    const mode_t mode = mode_of(flags, rest);
    va_end(rest);
    return refused(path, flags) ? -1 : real(path, flags, mode);
}

/* Below a folder that was opened before. */
static int refused_at(int folder, const char* path, int flags)
{
    if (folder == AT_FDCWD || *path == '/')
        return refused(path, flags);
    return (flags & O_ACCMODE) != O_RDONLY && is_file_under(folder) && fails("open");
}

int openat(int folder, const char* path, int flags, ...)
{
    REAL(openat);
    va_list rest;
    va_start(rest, flags);
    const mode_t mode = mode_of(flags, rest);
    va_end(rest);
    return refused_at(folder, path, flags) ? -1 : real(folder, path, flags, mode);
}

int openat64(int folder, const char* path, int flags, ...)
{
    REAL(openat64);
    va_list rest;
    va_start(rest, flags);
    const mode_t mode = mode_of(flags, rest);
    va_end(rest);
    return refused_at(folder, path, flags) ? -1 : real(folder, path, flags, mode);
}

ssize_t write(int file, const void* data, size_t size)
{
    REAL(write);
    return is_file_under(file) && fails("write") ? -1 : real(file, data, size);
}

ssize_t pwrite(int file, const void* data, size_t size, off_t offset)
{
    REAL(pwrite);
    return is_file_under(file) && fails("pwrite") ? -1 : real(file, data, size, offset);
}

ssize_t pwrite64(int file, const void* data, size_t size, off64_t offset)
{
    REAL(pwrite64);
    return is_file_under(file) && fails("pwrite") ? -1 : real(file, data, size, offset);
}

int fsync(int file)
{
    REAL(fsync);
    return is_file_under(file) && fails("fsync") ? -1 : real(file);
}

/* The descriptor is gone even where close() fails; that of a folder does not fail. */
int close(int file)
{
    REAL(close);
    struct stat status;
    const int is_file = fstat(file, &status) == 0 && S_ISREG(status.st_mode);
    const int is_ours = is_file && is_file_under(file);
    const int result = real(file);
    return is_ours && fails("close") ? -1 : result;
}

int linkat(int from_folder, const char* from, int to_folder, const char* to, int flags)
{
    REAL(linkat);
    return is_under(to) && fails("link") ? -1
                                         : real(from_folder, from, to_folder, to, flags);
}

int rename(const char* from, const char* to)
{
    REAL(rename);
    return is_under(to) && fails("rename") ? -1 : real(from, to);
}

int renameat(int from_folder, const char* from, int to_folder, const char* to)
{
    REAL(renameat);
    const int is_ours = *to != '/' && to_folder != AT_FDCWD ? is_file_under(to_folder)
                                                            : is_under(to);
    return is_ours && fails("rename") ? -1 : real(from_folder, from, to_folder, to);
}

int fchmod(int file, mode_t mode)
{
    REAL(fchmod);
    return is_file_under(file) && fails("fchmod") ? -1 : real(file, mode);
}

/* SPDX-License-Identifier: Apache-2.0
 * Copyright Contributors to the cg2raw Project.
 *
 * The calls on files that injector.h makes fail.
 */
#define _GNU_SOURCE
#include "injector.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

static int is_under(const char* path);

static int is_file_under(int file)
{
    char link[64], path[PATH_MAX + 1];
    const int before = errno;
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    const ssize_t size = readlink(link, path, PATH_MAX);
    errno = before;
    if (size < 0)
        return 0;
    path[size] = '\0';
    return is_under(path);
}

static int is_under(const char* path)
{
    const char* const folder = getenv("FAULT_UNDER");
    int file;
    if (sscanf(path, "/proc/self/fd/%d/", &file) == 1)
        return is_file_under(file);
    return folder && strncmp(path, folder, strlen(folder)) == 0;
}

/* Whether a call on an open file, or on a path, is to fail. */
static int fails(const char* call, int file)
{
    return fault_is_asked(call) && is_file_under(file) && fault_strikes();
}

static int fails_of(const char* call, const char* path)
{
    return fault_is_asked(call) && is_under(path) && fault_strikes();
}

/* The same of a path that may begin at an open folder. */
static int is_under_at(int folder, const char* path)
{
    return folder == AT_FDCWD || *path == '/' ? is_under(path) : is_file_under(folder);
}

static int fails_at(const char* call, int folder, const char* path)
{
    return fault_is_asked(call) && is_under_at(folder, path) && fault_strikes();
}

#define REAL(name) \
    static __typeof__(&name) real; \
    if (!real) \
        real = (__typeof__(&name))dlsym(RTLD_NEXT, #name)

static int refused_at(int folder, const char* path, int flags)
{
#ifdef O_TMPFILE
    if ((flags & O_TMPFILE) == O_TMPFILE && fault_is_asked("tmpfile")
        && is_under_at(folder, path)) {
        errno = EOPNOTSUPP;
        return 1;
    }
#endif
    const int reads = (flags & O_ACCMODE) == O_RDONLY;
    return fails_at(reads ? "open_to_read" : "open", folder, path);
}

static mode_t mode_of(int flags, va_list rest)
{
    const int makes = (flags & O_CREAT) || (flags & O_TMPFILE) == O_TMPFILE;
    return makes ? va_arg(rest, mode_t) : 0;
}

#define OPEN(name) \
    int name(const char* path, int flags, ...) \
    { \
        REAL(name); \
        va_list rest; \
        va_start(rest, flags); \
        const mode_t mode = mode_of(flags, rest); \
        va_end(rest); \
        return refused_at(AT_FDCWD, path, flags) ? -1 : real(path, flags, mode); \
    }
OPEN(open)
OPEN(open64)

#define OPENAT(name) \
    int name(int folder, const char* path, int flags, ...) \
    { \
        REAL(name); \
        va_list rest; \
        va_start(rest, flags); \
        const mode_t mode = mode_of(flags, rest); \
        va_end(rest); \
        return refused_at(folder, path, flags) ? -1 : real(folder, path, flags, mode); \
    }
OPENAT(openat)
OPENAT(openat64)

#define FOPEN(name) \
    FILE* name(const char* path, const char* mode) \
    { \
        REAL(name); \
        const int reads = *mode == 'r' && !strchr(mode, '+'); \
        return fails_of(reads ? "open_to_read" : "open", path) ? NULL \
                                                               : real(path, mode); \
    }
FOPEN(fopen)
FOPEN(fopen64)

/* A short one does half of what it is asked to do, and says so. */
static size_t part_of(const char* call, int file, size_t size)
{
    return size > 1 && fails(call, file) ? size / 2 : size;
}

ssize_t read(int file, void* data, size_t size)
{
    REAL(read);
    size = part_of("short_read", file, size);
    return fails("read", file) ? -1 : real(file, data, size);
}

#define AT_OFFSET(name, data_type, short_call, call, offset_type) \
    ssize_t name(int file, data_type data, size_t size, offset_type offset) \
    { \
        REAL(name); \
        size = part_of(short_call, file, size); \
        return fails(call, file) ? -1 : real(file, data, size, offset); \
    }
AT_OFFSET(pread, void*, "short_read", "read", off_t)
AT_OFFSET(pread64, void*, "short_read", "read", off64_t)
AT_OFFSET(pwrite, const void*, "short_write", "pwrite", off_t)
AT_OFFSET(pwrite64, const void*, "short_write", "pwrite", off64_t)

/* What ferror() tells, of glibc. */
static const int error_was_seen = 0x20;

size_t fread(void* data, size_t size, size_t count, FILE* file)
{
    REAL(fread);
    if (!fails("read", fileno(file)))
        return real(data, size, count, file);
    file->_flags |= error_was_seen;
    return 0;
}

size_t fwrite(const void* data, size_t size, size_t count, FILE* file)
{
    REAL(fwrite);
    if (!fails("write", fileno(file)))
        return real(data, size, count, file);
    file->_flags |= error_was_seen;
    return 0;
}

ssize_t write(int file, const void* data, size_t size)
{
    REAL(write);
    size = part_of("short_write", file, size);
    return fails("write", file) ? -1 : real(file, data, size);
}

ssize_t writev(int file, const struct iovec* parts, int count)
{
    REAL(writev);
    return fails("write", file) ? -1 : real(file, parts, count);
}

#define LSEEK(name, offset_type) \
    offset_type name(int file, offset_type offset, int whence) \
    { \
        REAL(name); \
        return fails("lseek", file) ? -1 : real(file, offset, whence); \
    }
LSEEK(lseek, off_t)
LSEEK(lseek64, off64_t)

#define FTRUNCATE(name, offset_type) \
    int name(int file, offset_type size) \
    { \
        REAL(name); \
        return fails("ftruncate", file) ? -1 : real(file, size); \
    }
FTRUNCATE(ftruncate, off_t)
FTRUNCATE(ftruncate64, off64_t)

#define MMAP(name, offset_type) \
    void* name(void* at, size_t size, int protection, int flags, int file, \
               offset_type offset) \
    { \
        REAL(name); \
        return file >= 0 && fails("mmap", file) \
            ? MAP_FAILED \
            : real(at, size, protection, flags, file, offset); \
    }
MMAP(mmap, off_t)
MMAP(mmap64, off64_t)

int fsync(int file)
{
    REAL(fsync);
    return fails("fsync", file) ? -1 : real(file);
}

/* The descriptor is gone even where close() fails; that of a folder does not fail. */
int close(int file)
{
    REAL(close);
    if (!fault_is_asked("close"))
        return real(file);
    struct stat status;
    const int is_file = fstat(file, &status) == 0 && S_ISREG(status.st_mode);
    const int is_ours = is_file && is_file_under(file);
    const int result = real(file);
    return is_ours && fault_strikes() ? -1 : result;
}

int fclose(FILE* file)
{
    REAL(fclose);
    if (!fault_is_asked("close"))
        return real(file);
    const int is_ours = is_file_under(fileno(file));
    const int result = real(file);
    return is_ours && fault_strikes() ? EOF : result;
}

int link(const char* from, const char* to)
{
    REAL(link);
    return fails_of("link", to) ? -1 : real(from, to);
}

int linkat(int from_folder, const char* from, int to_folder, const char* to, int flags)
{
    REAL(linkat);
    return fails_at("link", to_folder, to)
        ? -1
        : real(from_folder, from, to_folder, to, flags);
}

int rename(const char* from, const char* to)
{
    REAL(rename);
    return fails_of("rename", to) ? -1 : real(from, to);
}

int renameat(int from_folder, const char* from, int to_folder, const char* to)
{
    REAL(renameat);
    return fails_at("rename", to_folder, to) ? -1
                                             : real(from_folder, from, to_folder, to);
}

int mkdir(const char* path, mode_t mode)
{
    REAL(mkdir);
    return fails_of("mkdir", path) ? -1 : real(path, mode);
}

int mkdirat(int folder, const char* path, mode_t mode)
{
    REAL(mkdirat);
    return fails_at("mkdir", folder, path) ? -1 : real(folder, path, mode);
}

int fchmod(int file, mode_t mode)
{
    REAL(fchmod);
    return fails("fchmod", file) ? -1 : real(file, mode);
}

int flock(int file, int operation)
{
    REAL(flock);
    return fails("flock", file) ? -1 : real(file, operation);
}

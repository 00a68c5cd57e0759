/* SPDX-License-Identifier: Apache-2.0
 * Copyright Contributors to the cg2raw Project.
 *
 * Which call is to fail, and a program that forks for each of many.
 */
#define _GNU_SOURCE
#include "injector.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

static struct {
    char call[32];
    int number, nth, sticky, no_tmpfile;
} asked;
static int calls;

void fault_begin(const char* words)
{
    asked.call[0] = '\0';
    calls = 0;
    char call[32] = "";
    if (sscanf(words, "%31s %d %d %d %d", call, &asked.number, &asked.nth,
               &asked.sticky, &asked.no_tmpfile)
        == 5)
        strcpy(asked.call, call);
}

int fault_is_asked(const char* call)
{
    if (strcmp(call, "tmpfile") == 0)
        return asked.no_tmpfile;
    return strcmp(asked.call, call) == 0;
}

/* By the system's own calls, which are not made to fail. */
static void log_it(void)
{
    const char* const path = getenv("FAULT_LOG");
    const long file = path ? syscall(SYS_openat, AT_FDCWD, path,
                                     O_WRONLY | O_CREAT | O_APPEND, 0600)
                           : -1;
    if (file >= 0) {
        if (syscall(SYS_write, file, "x", 1) != 1)
            abort();
        syscall(SYS_close, file);
    }
}

int fault_strikes(void)
{
    const int count = __sync_add_and_fetch(&calls, 1);
    if (count < asked.nth || (count > asked.nth && !asked.sticky))
        return 0;
    log_it();
    errno = asked.number;
    return 1;
}

static const char* word(const char* name)
{
    const char* const value = getenv(name);
    return value && *value ? value : "0";
}

__attribute__((constructor)) static void begin_by_environment(void)
{
    char words[128];
    snprintf(words, sizeof words, "%.31s %.9s %.9s %.1s %.1s", word("FAULT_CALL"),
             word("FAULT_ERRNO"), word("FAULT_NTH"), word("FAULT_STICKY"),
             word("FAULT_NO_TMPFILE"));
    fault_begin(words);
}

static int (*program)(int, char**, char**);

/* Returns in a child, once for each line; the parent ends with its input. */
static void serve(void)
{
    char line[128];
    size_t size = 0;
    while (read(0, line + size, 1) == 1) {
        if (line[size] != '\n' && size < sizeof line - 2) {
            ++size;
            continue;
        }
        line[size] = '\0';
        size = 0;
        const pid_t child = fork();
        if (child == 0) {
            fault_begin(line);
            return;
        }
        int status = 0;
        dprintf(1, "%d\n", (int)child);
        while (waitpid(child, &status, 0) < 0 && errno == EINTR)
            ;
        dprintf(1, "%d\n", status);
    }
    _exit(0);
}

/* What libraries began before main() waits for threads, which a fork does not have. */
static void end(int code, void* unused)
{
    (void)unused;
    fflush(NULL);
    _exit(code);
}

/* What the program prints goes to standard error. */
static int served(int count, char** words, char** environment)
{
    unsetenv("FAULT_SERVER"); /* processes that it starts do not serve */
    serve();
    dup2(2, 1);
    const int nothing = (int)syscall(SYS_openat, AT_FDCWD, "/dev/null", O_RDONLY, 0);
    dup2(nothing, 0);
    on_exit(end, NULL);
    return program(count, words, environment);
}

int __libc_start_main(int (*main)(int, char**, char**), int count, char** words,
                      void (*init)(void), void (*fini)(void), void (*rtld_fini)(void),
                      void* stack_end)
{
    __typeof__(&__libc_start_main) real
        = (__typeof__(&__libc_start_main))dlsym(RTLD_NEXT, "__libc_start_main");
    program = main;
    const char* const server = getenv("FAULT_SERVER");
    return real(server && *server == '1' ? served : main, count, words, init, fini,
                rtld_fini, stack_end);
}

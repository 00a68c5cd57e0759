# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Memory that was freed, for programs that make the same arrays again and again."""

import ctypes
import platform

# Options of glibc's mallopt(3), and bytes. Above the first, its default gives every
# array back to the system, which clears its pages for the next.
OPTIONS = {
    -3: 32 << 20,  # M_MMAP_THRESHOLD, at its upper bound
    -1: 1 << 30,  # M_TRIM_THRESHOLD
    -2: 64 << 20,  # M_TOP_PAD
}


def keep_freed_memory() -> None:
    """Let the process keep up to 1 GiB that it freed for what it allocates next, where
    glibc has the memory; elsewhere, do nothing."""
    if platform.libc_ver()[0] == "glibc":
        mallopt = ctypes.CDLL(None).mallopt
        for option, value in OPTIONS.items():
            mallopt(option, value)

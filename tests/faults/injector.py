# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Calls that fail: the injector of injector.h, compiled, and what asks it to."""

import ctypes
import os
import shutil
import subprocess
from pathlib import Path

import pytest

HERE = Path(__file__).parent
SOURCES = [HERE / name for name in ("injector.c", "settings.c", "allocations.cpp")]
# Each with the errors that the system may well give; none: it only does less.
CALLS = {
    "open": ("EACCES", "ENOSPC"),
    "open_to_read": ("EIO", "EMFILE"),
    "read": ("EIO",),
    "short_read": ("0",),
    "write": ("ENOSPC", "EDQUOT"),
    "short_write": ("0",),
    "pwrite": ("ENOSPC", "EDQUOT"),
    "lseek": ("EIO",),
    "ftruncate": ("EIO",),
    "fsync": ("EIO",),
    "close": ("EIO", "EDQUOT"),
    "link": ("EPERM", "ENOSPC"),
    "rename": ("EACCES", "ENOSPC"),
    "mkdir": ("EACCES", "ENOSPC"),
    "fchmod": ("EIO",),
    "mmap": ("ENOMEM",),
    "malloc": ("0",),
}


def compiled(folder):
    """Return the path of the injector, compiled into a folder, or skip the test."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler")
    library = folder / "injector.so"
    options = ["-shared", "-fPIC", "-O1", "-w", "-o", library]
    command = [compiler, *options, *SOURCES, "-ldl", "-lstdc++"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        pytest.skip(f"the injector is of Linux with glibc: {done.stderr[-500:]}")
    return library


def words_of(call, number=0, nth=1, sticky=False, tmpfile=True):
    """Return what fault_begin() and a server of injector.h take."""
    return f"{call} {number} {nth} {int(sticky)} {int(not tmpfile)}"


def begin(words):
    """Let calls of this process, which runs under the injector, fail from now on."""
    ctypes.CDLL(None).fault_begin(words.encode())


def environment_of(words):
    """Return the variables that say the same to a process that is to be started."""
    names = ("CALL", "ERRNO", "NTH", "STICKY", "NO_TMPFILE")
    return {
        f"FAULT_{name}": word for name, word in zip(names, words.split(), strict=True)
    }


class Injector:
    """Environments in which a call on files of one folder fails.

    folder : of the files. scratch : another one, for what the injector needs."""

    def __init__(self, library, folder, scratch):
        self.library, self.folder = library, os.path.realpath(folder)
        self.log = scratch / "faults.log"

    def environment(self, call, number=0, nth=1, sticky=False, tmpfile=True):
        """Return the variables that make the nth call fail with an errno."""
        self.forget()
        return {
            "LD_PRELOAD": str(self.library),
            "FAULT_UNDER": self.folder,
            "FAULT_LOG": str(self.log),
            **environment_of(words_of(call, number, nth, sticky, tmpfile)),
        }

    def forget(self):
        """Forget that a call was made to fail."""
        self.log.unlink(missing_ok=True)

    @property
    def fired(self):
        """Return whether a call was made to fail."""
        return self.log.exists()

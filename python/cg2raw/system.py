# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What differs between Linux, macOS and Windows; nothing else asks which one it is."""

import contextlib
import ctypes
import errno
import os
import signal
import subprocess
import sys

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

PR_SET_PDEATHSIG = 1  # Source: Linux, prctl(2)


# What OpenImageIO calls a plugin. Source: Plugin::plugin_extension() of its plugin.cpp.
PLUGIN_SUFFIX = ".dll" if sys.platform == "win32" else ".so"


def has_folder(word: str) -> bool:
    """Return whether a word is a path with a folder, and no bare name."""
    return os.path.dirname(word) != ""


def usable_cores() -> int:
    """Return how many cores this process may use."""
    if sys.platform == "linux":
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def open_without_links(path: str | os.PathLike[str], flags: int) -> int:
    """Return a descriptor of the file at @path, as os.open. A link raises OSError."""
    if sys.platform != "win32":
        return os.open(path, flags | os.O_NOFOLLOW, 0o666)
    if os.path.islink(path):
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), os.fspath(path))
    return os.open(path, flags | os.O_BINARY, 0o666)


def lock(handle: int) -> None:
    """Lock a file until it is closed. Raises OSError if another process has done so."""
    if sys.platform == "win32":
        msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
    else:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)


def set_mode(handle: int, mode: int) -> None:
    """Give an open file permissions, where the system has them."""
    if sys.platform != "win32":
        os.fchmod(handle, mode)


def sync(handle: int) -> None:
    """Put a file on the disk; what has none, such as a pipe, stays as it is."""
    if sys.platform == "darwin":  # its fsync() leaves bytes in the drive's cache
        with contextlib.suppress(OSError):
            fcntl.fcntl(handle, fcntl.F_FULLFSYNC)
            return
    try:
        os.fsync(handle)
    except OSError as error:
        no_disk = errno.EBADF if sys.platform == "win32" else errno.EINVAL
        if error.errno != no_disk:
            raise


def sync_folder(folder: str) -> None:
    """Make names in a folder outlast a loss of power, where the system can."""
    if sys.platform == "win32":
        return
    with contextlib.suppress(OSError):
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        try:
            sync(handle)
        finally:
            os.close(handle)


def sync_file_system(folder: str) -> None:
    """Put all files of the file system that @folder is on onto the disk.

    On Windows that takes an administrator: nothing is done."""
    if sys.platform == "linux":
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        try:
            ctypes.CDLL(None).syncfs(handle)
        finally:
            os.close(handle)
    elif sys.platform != "win32":
        os.sync()


def new_session() -> int:
    """Return the creationflags of a subprocess.Popen with start_new_session=True."""
    if sys.platform == "win32":  # which does not know start_new_session
        return subprocess.CREATE_NEW_PROCESS_GROUP
    return 0


def end_with_parent(parent: int) -> None:
    """Let the system kill this process when its parent is killed.

    Elsewhere than on Linux, it ends when it next reads from a pipe of its parent."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        sys.exit(1)

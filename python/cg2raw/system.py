# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What differs between Linux, macOS and Windows; nothing else asks which one it is."""

import contextlib
import ctypes
import errno
import os
import platform
import signal
import stat
import subprocess
import sys
from collections.abc import Iterator
from pathlib import PurePath
from types import TracebackType

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

if sys.platform == "win32":
    OPEN_FILE, OPEN_FOLDER = os.O_BINARY, 0
    READ_FILE = os.O_RDONLY | os.O_BINARY
else:
    # A pipe that nobody has at its other end is opened at once, to be refused.
    OPEN_FILE = os.O_NOFOLLOW | os.O_NONBLOCK
    OPEN_FOLDER = os.O_RDONLY | os.O_DIRECTORY
    READ_FILE = os.O_RDONLY | os.O_NONBLOCK
OPEN_FILES = "/proc/self/fd"
# What is said of a lock that another process has: flock(2), msvcrt.locking.
LOCKED = (errno.EWOULDBLOCK, errno.EACCES, errno.EDEADLK)
PR_SET_PDEATHSIG = 1  # Source: Linux, prctl(2)
# Options of glibc's mallopt(3), and bytes. Above the first, its default gives every
# array back to the system, which clears its pages for the next.
MALLOC_OPTIONS = {
    -3: 32 << 20,  # M_MMAP_THRESHOLD, at its upper bound
    -1: 1 << 30,  # M_TRIM_THRESHOLD
    -2: 64 << 20,  # M_TOP_PAD
}


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


def check_readable(path: str | os.PathLike[str]) -> None:
    """Raise OSError, with the system's reason, unless @path is a file to be read.

    A pipe is none: whoever opens it would wait for its other end."""
    handle = os.open(path, READ_FILE)
    try:
        mode = os.fstat(handle).st_mode
    finally:
        os.close(handle)
    check_regular(path, mode)


def check_regular(path: str | os.PathLike[str], mode: int) -> None:
    """Raise OSError unless the mode that the system says of @path is of a file."""
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if not stat.S_ISREG(mode):
        raise OSError(f"{path}: is no regular file")


@contextlib.contextmanager
def naming(path: str) -> Iterator[None]:
    """Give @path to what the system says of a call that knows a part of it, or none."""
    try:
        yield
    except OSError as error:
        if error.strerror:
            error.filename, error.filename2 = path, None
        raise


class Folder:
    """A folder whose files are reached without following a link; a context manager.

    It stays the one that was opened, whatever its name leads to later, but on Windows,
    which opens no folders: there each call asks whether a name is a link. What is said
    of a link or of what is no file is one line that begins with its path."""

    def __init__(self, root: str, below: str = "", make: bool = False) -> None:
        """Open the folder at a relative path @below a folder.

        make : those below that are missing. Raises OSError."""
        self.path, self.handle = root, -1
        if sys.platform != "win32":
            self.handle = os.open(root, OPEN_FOLDER)
        try:
            for name in PurePath(below).parts:
                self._go_into(name, make)
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> "Folder":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the folder."""
        if self.handle >= 0:
            os.close(self.handle)
        self.handle = -1

    def path_of(self, name: str) -> str:
        """Return the path of a name in the folder."""
        return os.path.join(self.path, name)

    @contextlib.contextmanager
    def path_for(self, name: str) -> Iterator[str]:
        """Give a path of a name to what writes files by path: where the system has one
        (Linux, /proc), it leads into this folder whatever the folder's name leads to
        meanwhile. What is said of it is said of the name's own path."""
        path = own = self.path_of(name)
        if self.handle >= 0 and os.path.exists(f"{OPEN_FILES}/{self.handle}"):
            path = f"{OPEN_FILES}/{self.handle}/{name}"
        with naming(own):
            try:
                yield path
            except Exception as error:
                error.args = tuple(
                    one.replace(path, own) if isinstance(one, str) else one
                    for one in error.args
                )
                raise

    def open(self, name: str, flags: int) -> int:
        """Return a descriptor of a regular file, as os.open. Raises OSError."""
        at, where = self._at(name)
        if self.handle < 0:
            self._refuse_link(name)
        try:
            handle = os.open(where, flags | OPEN_FILE, 0o666, dir_fd=at)
        except OSError:
            with naming(self.path_of(name)):
                self._refuse_link(name)
                raise
        if stat.S_ISREG(os.fstat(handle).st_mode):
            return handle
        os.close(handle)
        raise OSError(f"{self.path_of(name)}: is no regular file; remove it")

    def status(self, name: str) -> os.stat_result:
        """Return what the system knows of a name. Raises OSError."""
        at, where = self._at(name)
        with naming(self.path_of(name)):
            return os.stat(where, dir_fd=at, follow_symlinks=False)

    def names(self) -> list[str]:
        """Return the names in the folder, sorted."""
        with naming(self.path):
            return sorted(os.listdir(self.path if self.handle < 0 else self.handle))

    def replace(self, name: str, other: "Folder", new: str) -> None:
        """Move a file to a name in another folder, where it replaces any, or a link."""
        (at, where), (to, there) = self._at(name), other._at(new)
        with naming(other.path_of(new)):
            os.replace(where, there, src_dir_fd=at, dst_dir_fd=to)

    def remove(self, name: str) -> None:
        """Remove a file, or a link. Raises OSError."""
        at, where = self._at(name)
        with naming(self.path_of(name)):
            os.unlink(where, dir_fd=at)

    def _at(self, name: str) -> tuple[int | None, str]:
        """Return (dir_fd, path) of a name, as the functions of os take them."""
        return (None, self.path_of(name)) if self.handle < 0 else (self.handle, name)

    def _go_into(self, name: str, make: bool) -> None:
        if name == os.pardir or os.path.isabs(name):
            raise OSError(f"{self.path_of(name)}: is not below {self.path}")
        at, where = self._at(name)
        if make:
            with contextlib.suppress(FileExistsError), naming(self.path_of(name)):
                os.mkdir(where, dir_fd=at)
        self._refuse_link(name)
        if sys.platform != "win32":
            with naming(self.path_of(name)):
                inner = os.open(where, OPEN_FOLDER | os.O_NOFOLLOW, dir_fd=at)
            os.close(self.handle)
            self.handle = inner
        self.path = self.path_of(name)

    def _refuse_link(self, name: str) -> None:
        """Say of a link that it is one; the system refuses it too, in other words."""
        with contextlib.suppress(FileNotFoundError):
            if stat.S_ISLNK(self.status(name).st_mode):
                path = self.path_of(name)
                raise OSError(f"{path}: is a link, which is not ours; remove it")


def lock(handle: int) -> bool:
    """Lock a file until it is closed; return False if its file system has no locks.

    Raises BlockingIOError if another process has locked it."""
    try:
        if sys.platform == "win32":
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
        else:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        if error.errno in LOCKED:
            raise BlockingIOError(*error.args) from None
        # Lustre says ENOSYS, NFS without its daemon ENOLCK, others what they like.
        return False
    return True


def sync_folder(folder: str) -> None:
    """Make names in a folder outlast a loss of power, where the system can."""
    if sys.platform == "win32":
        return
    with contextlib.suppress(OSError):
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        try:
            if sys.platform == "darwin":  # its fsync() leaves it in the drive's cache
                fcntl.fcntl(handle, fcntl.F_FULLFSYNC)
            else:
                os.fsync(handle)
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


def keep_freed_memory() -> None:
    """Let the process keep up to 1 GiB that it freed for what it allocates next, where
    glibc has the memory; elsewhere, do nothing."""
    if platform.libc_ver()[0] == "glibc":
        mallopt = ctypes.CDLL(None).mallopt
        for option, value in MALLOC_OPTIONS.items():
            mallopt(option, value)


def new_session() -> int:
    """Return the creationflags of a subprocess.Popen with start_new_session=True."""
    if sys.platform == "win32":  # which does not know start_new_session
        return subprocess.CREATE_NEW_PROCESS_GROUP
    return 0


@contextlib.contextmanager
def children_without_ctrl_c() -> Iterator[None]:
    """Let processes that are started in the block leave Ctrl-C to this one, which
    answers it afterwards; on Windows they get it too."""
    if sys.platform == "win32":
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def end_process(process: int) -> None:
    """Kill a child of this process at once, and wait for its end. Raises OSError."""
    if sys.platform == "win32":
        os.kill(process, signal.SIGTERM)  # which is TerminateProcess there
    else:
        os.kill(process, signal.SIGKILL)
        os.waitpid(process, 0)


def end_with_parent(parent: int) -> None:
    """Let the system kill this process when its parent is killed.

    Elsewhere than on Linux, it ends when it next reads from a pipe of its parent."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        sys.exit(1)

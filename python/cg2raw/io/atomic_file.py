# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Atomic files: they appear whole or not at all."""

import contextlib
import os
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator
from typing import BinaryIO, Protocol

from cg2raw.system import open_without_links, set_mode, sync, sync_folder

FilePath = str | os.PathLike[str]


class Files(Protocol):
    """Names and bytes of files, which may be made one at a time."""

    def items(self) -> Iterable[tuple[str, bytes]]:
        """Return the pairs."""
        ...


def write_atomically(path: FilePath, data: bytes) -> None:
    """Write bytes to @path: a temporary file beside it takes its place when complete.

    A symbolic link stays one; what is no regular file, such as /dev/stdout, is written
    to as it is. Raises OSError naming @path; an existing file is then as it was."""
    target = os.path.realpath(path)
    if os.path.isdir(target):
        raise OSError(f"{path}: is a folder")
    if os.path.exists(target) and not os.path.isfile(target):
        write_all(path, path, data)
        return
    folder, name = os.path.split(target)
    with failing(path):
        handle, part = tempfile.mkstemp(prefix=f".{name[:32]}.", dir=folder)
    try:
        with failing(path):
            set_mode(handle, mode_of(target))
        write_all(handle, path, data)
        with failing(path):
            os.replace(part, target)
    except BaseException:
        # Not there any more if the last call was interrupted after its work.
        with contextlib.suppress(FileNotFoundError):
            os.unlink(part)
        raise
    sync_folder(folder)


def write_folder(path: FilePath, files: Files, is_ours: Callable[[str], bool]) -> None:
    """Write a folder of files, {name: bytes}; one that is there is replaced as a whole.

    is_ours : name -> whether a file that is there may go. Raises ValueError if one may
    not, OSError naming @path; an existing folder is then as it was, or, if it cannot be
    moved back, where the message says."""
    target = os.path.realpath(path)
    if os.path.lexists(target) and not os.path.isdir(target):
        raise ValueError(f"{path}: is there already and no folder; remove it")
    foreign = os.path.isdir(target) and sorted(
        name for name in os.listdir(target) if not is_ours(name)
    )
    if foreign:
        raise ValueError(f"{path}: holds {foreign[0]}, which is not ours; remove it")
    parent = os.path.dirname(target)
    with failing(path):
        part = tempfile.mkdtemp(prefix=".cg2raw.", dir=parent)
    fresh, old = os.path.join(part, "new"), os.path.join(part, "old")
    try:
        with failing(path):
            os.mkdir(fresh)  # with the permissions of any new folder
        for name, data in files.items():
            write_all(os.path.join(fresh, name), path, data)
        exchange(path, target, fresh, old)
    except BaseException:
        move_back(path, target, old)
        raise
    finally:
        # What could not be moved back stays where it is.
        if os.path.exists(target) or not os.path.exists(old):
            shutil.rmtree(part, ignore_errors=True)
    sync_folder(parent)


def exchange(path: FilePath, target: str, fresh: str, old: str) -> None:
    """Move the folder @target, if there is one, to @old, and @fresh in its place."""
    with failing(path):
        if os.path.isdir(target):
            os.rename(target, old)
        os.rename(fresh, target)


def move_back(path: FilePath, target: str, old: str) -> None:
    """Move what was at @target back from @old. Raises OSError if it must stay there."""
    if not os.path.isdir(old) or os.path.lexists(target):
        return
    try:
        os.rename(old, target)
    except OSError as error:
        raise OSError(
            f"{path}: cannot be replaced, nor moved back: {error.strerror}; what was "
            f"there is in {old}"
        ) from None


def write_all(file: FilePath | int, path: FilePath, data: bytes) -> None:
    """Write @data to @file, a path or descriptor, and close it; messages name @path.

    It is on the disk then."""
    with failing(path), open(file, "wb") as stream:
        stream.write(data)
        stream.flush()
        sync(stream.fileno())


@contextlib.contextmanager
def failing(path: FilePath) -> Iterator[None]:
    """Name @path in what the system says of a call that fails."""
    try:
        yield
    except OSError as error:
        raise OSError(f"{path}: cannot be written: {error.strerror}") from None


def create(path: FilePath) -> BinaryIO:
    """Return a binary stream of a new file at @path, which replaces any; no link is
    followed. Raises OSError."""
    with contextlib.suppress(FileNotFoundError):
        os.unlink(path)
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL
    return open(open_without_links(path, flags), "wb")


def mode_of(target: str) -> int:
    """Return the permissions of the file at @target, or those of a new one."""
    if os.path.exists(target):
        return os.stat(target).st_mode & 0o7777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask

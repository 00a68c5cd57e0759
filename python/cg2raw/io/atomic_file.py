# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Atomic files: they appear whole or not at all."""

import contextlib
import os
import secrets
import shutil
import stat
import string
import tempfile
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import BinaryIO, Protocol

from cg2raw.core_arguments import check_utf8, has_surrogates
from cg2raw.interrupts import held, tidied
from cg2raw.system import Folder, open_without_links, set_mode, sync, sync_folder

FilePath = str | os.PathLike[str]

TRIES = 100  # names for a temporary file
LETTERS = string.ascii_lowercase + string.digits  # of such a name


@contextlib.contextmanager
def utf8_path(path: FilePath) -> Iterator[str]:
    """Give a path in UTF-8 to what takes no other: where a folder is not, as one above
    the work may be, the path leads through an open descriptor (Linux, /proc).

    Raises ValueError for another name of a file, OSError."""
    folder, name = os.path.split(os.fspath(path))
    if not has_surrogates(folder) or has_surrogates(name):
        check_utf8(os.fspath(path))
        yield os.fspath(path)
        return
    with Folder(folder) as opened, opened.path_for(name) as way:
        check_utf8(way)
        yield way


class Files(Protocol):
    """Names and bytes of files, which may be made one at a time."""

    def items(self) -> Iterable[tuple[str, bytes]]:
        """Return the pairs."""
        ...


def write_atomically(path: FilePath, data: bytes) -> None:
    """Write bytes to @path: a temporary file beside it takes its place when complete.

    A symbolic link stays one, and what it leads to is written, there already or not;
    what is no regular file, such as /dev/stdout, is written to as it is. A file that is
    there keeps its permissions. Raises OSError naming @path, also for a circle of
    links; an existing file is then as it was."""
    target = os.path.realpath(path)
    if os.path.isdir(target):
        raise OSError(f"{path}: is a folder")
    if os.path.islink(target):
        raise OSError(f"{path}: cannot be written: its links lead in a circle")
    if os.path.exists(target) and not os.path.isfile(target):
        write_all(path, path, data)
        return
    folder, name = os.path.split(target)
    with failing(path):
        opened = Folder(folder)
    with opened:
        write_in(opened, name, data, path)


@held()
def write_with_folder(path: FilePath, data: bytes) -> None:
    """Write bytes to @path as write_atomically, in a folder that is made if it is not
    there, and gone again if they cannot be written. Raises OSError naming @path."""
    folder = os.path.dirname(os.path.abspath(path))
    is_new = not os.path.isdir(folder)
    if is_new:
        with failing(path):
            os.makedirs(folder)
    try:
        write_atomically(path, data)
    except BaseException:
        if is_new:
            with contextlib.suppress(OSError):  # what others have put there stays
                os.rmdir(folder)
        raise


@held()
def write_in(folder: Folder, name: str, data: bytes, path: FilePath) -> None:
    """Write bytes to a name in a Folder, as write_atomically; a link of that name is
    replaced. Raises OSError naming @path."""
    with failing(path):
        handle, part = new_file(folder, name)
    try:
        write_all(handle, path, data)
        with failing(path):
            folder.replace(part, folder, name)
    except BaseException:
        # Not there any more if the last call was interrupted after its work.
        with contextlib.suppress(FileNotFoundError):
            folder.remove(part)
        raise
    sync_folder(folder.path)


def new_file(folder: Folder, name: str) -> tuple[int, str]:
    """Return (descriptor, name) of a new file that is to take the place of @name.

    It has the permissions of a file there, or those of any new one; its name is one
    that nobody can foresee. Raises OSError."""
    mode = mode_in(folder, name)
    for tries_left in reversed(range(TRIES)):
        ending = "".join(secrets.choice(LETTERS) for _ in range(8))
        part = f".{name[:32]}.{ending}"
        try:
            flags = os.O_RDWR | os.O_CREAT | os.O_EXCL
            handle = folder.open(part, flags, 0o666 if mode is None else mode)
        except FileExistsError:
            if not tries_left:
                raise
            continue
        break
    try:
        if mode is not None:
            set_mode(handle, mode)
    except BaseException:
        os.close(handle)
        folder.remove(part)
        raise
    return handle, part


def mode_in(folder: Folder, name: str) -> int | None:
    """Return the permissions of a file in a folder, None if there is none."""
    try:
        status = folder.status(name)
    except FileNotFoundError:
        return None
    return status.st_mode & 0o777 if stat.S_ISREG(status.st_mode) else None


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
    with contextlib.ExitStack() as undo:
        with held():
            with failing(path):
                part = tempfile.mkdtemp(prefix=".cg2raw.", dir=os.path.dirname(target))
            undo.enter_context(tidied(partial(remove_tree, part)))
        fresh = os.path.join(part, "new")
        try:
            with failing(path):
                os.mkdir(fresh)  # with the permissions of any new folder, or the old
                if os.path.isdir(target):
                    shutil.copymode(target, fresh)
            for name, data in files.items():
                write_all(os.path.join(fresh, name), path, data)
        except BaseException:
            remove_tree(part)
            raise
        with held():
            undo.close()
            _exchange_or_stay(path, target, part)
    sync_folder(os.path.dirname(target))


def _exchange_or_stay(path: FilePath, target: str, part: str) -> None:
    """Put part/new in the place of the folder @target, which comes back if that fails;
    remove @part."""
    old = os.path.join(part, "old")
    try:
        exchange(path, target, os.path.join(part, "new"), old)
    except BaseException:
        move_back(path, target, old)
        raise
    finally:
        # What could not be moved back stays where it is.
        if os.path.exists(target) or not os.path.exists(old):
            remove_tree(part)


def remove_tree(folder: str) -> None:
    """Remove a folder of ours with all in it, as far as the system lets; also where it
    opens no more files, as shutil.rmtree does."""
    shutil.rmtree(folder, ignore_errors=True)
    for below, folders, names in os.walk(folder, topdown=False):
        for name in (*names, *folders):
            path = os.path.join(below, name)
            with contextlib.suppress(OSError):
                os.unlink(path) if name in names else os.rmdir(path)
    with contextlib.suppress(OSError):
        os.rmdir(folder)


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
        if error.strerror is None:  # in our words
            raise
        raise OSError(f"{path}: cannot be written: {error.strerror}") from None


def create(path: FilePath) -> BinaryIO:
    """Return a binary stream of a new file at @path, which replaces any; no link is
    followed. Raises OSError."""
    with contextlib.suppress(FileNotFoundError):
        os.unlink(path)
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL
    return open(open_without_links(path, flags), "wb")

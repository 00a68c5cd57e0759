# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Atomic files: they appear whole or not at all, by one call of the core, which no
signal cuts in two."""

import contextlib
import os
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import Any, BinaryIO, Protocol

from cg2raw import _core
from cg2raw.core_arguments import check_utf8, has_surrogates
from cg2raw.interrupts import held, tidied
from cg2raw.system import Folder, sync_folder

FilePath = str | os.PathLike[str]


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
    """Write bytes to @path, where they appear whole or not at all.

    A symbolic link stays one, and what it leads to is written, there already or not;
    what is no regular file, such as /dev/stdout, is written to as it is. A file that is
    there keeps its permissions. Raises OSError naming @path, also for a circle of
    links; an existing file is then as it was."""
    if os.path.exists(path) and not (os.path.isfile(path) or os.path.isdir(path)):
        with failing(path), open(path, "wb") as stream:
            stream.write(data)
        return
    _write(path, data)


def write_in(folder: Folder, name: str, data: bytes, path: FilePath) -> None:
    """Write bytes to a name in a Folder, as write_atomically; a link of that name is
    replaced. Raises OSError naming @path."""
    place = folder.path_of(name) if folder.handle < 0 else name
    _write(path, data, folder.handle, os.fsencode(place))


def _write(path: FilePath, data: bytes, *place: Any) -> None:
    try:
        _core.write_file(os.fsencode(path), data, *place)
    except ValueError as error:
        raise OSError(str(error)) from None


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
                folder = undo.enter_context(Folder(fresh))
            for name, data in files.items():
                write_in(folder, name, data, path)
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
    return open(path, "xb")

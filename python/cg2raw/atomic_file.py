# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Files that appear whole or not at all."""

import os
import shutil
import tempfile


def write_atomically(path, data):
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
    try:
        handle, part = tempfile.mkstemp(prefix=f".{name[:32]}.", dir=folder)
    except OSError as error:
        raise OSError(f"{path}: cannot be written: {error.strerror}") from None
    try:
        os.fchmod(handle, mode_of(target))
        write_all(handle, path, data)
        os.replace(part, target)
    except BaseException:
        os.unlink(part)
        raise


def write_folder(path, files, is_ours):
    """Write a folder of files, {name: bytes}; one that is there is replaced as a whole.

    is_ours : name -> whether a file that is there may go. Raises ValueError if one may
    not, OSError naming @path; an existing folder is then as it was."""
    target = os.path.realpath(path)
    if os.path.lexists(target) and not os.path.isdir(target):
        raise ValueError(f"{path}: is there already and no folder; remove it")
    foreign = os.path.isdir(target) and sorted(
        name for name in os.listdir(target) if not is_ours(name)
    )
    if foreign:
        raise ValueError(f"{path}: holds {foreign[0]}, which is not ours; remove it")
    try:
        part = tempfile.mkdtemp(prefix=".cg2raw.", dir=os.path.dirname(target))
    except OSError as error:
        raise OSError(f"{path}: cannot be written: {error.strerror}") from None
    try:
        fresh, old = os.path.join(part, "new"), os.path.join(part, "old")
        os.mkdir(fresh)  # with the permissions of any new folder
        for name, data in files.items():
            write_all(os.path.join(fresh, name), path, data)
        if os.path.isdir(target):
            os.rename(target, old)
        os.rename(fresh, target)
    except BaseException:
        if os.path.isdir(old) and not os.path.exists(target):
            os.rename(old, target)
        raise
    finally:
        shutil.rmtree(part, ignore_errors=True)


def write_all(file, path, data):
    """Write @data to @file, a path or descriptor, and close it; messages name @path."""
    try:
        with open(file, "wb") as stream:
            stream.write(data)
            stream.flush()
            if isinstance(file, int):
                os.fsync(stream.fileno())
    except OSError as error:
        raise OSError(f"{path}: cannot be written: {error.strerror}") from None


def mode_of(target):
    """Return the permissions of the file at @target, or those of a new one."""
    if os.path.exists(target):
        return os.stat(target).st_mode & 0o7777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask

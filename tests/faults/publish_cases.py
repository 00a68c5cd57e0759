# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Run under the injector: writes a file again and again while calls fail.

publish_cases.py FOLDER LOG ROUTE prints a JSON line of each call that failed: which,
the error, whether the old bytes are there or the new ones, and what is left in the
folder.
"""

import errno
import itertools
import json
import shutil
import sys
from pathlib import Path

import numpy as np

import cg2raw
from cg2raw.dataset import journal
from cg2raw.io.atomic_file import write_atomically, write_folder
from faults.injector import begin as begin_fault
from faults.injector import words_of

CALLS = ("open", "write", "pwrite", "fsync", "close", "link", "rename", "fchmod")
NUMBERS = ("ENOSPC", "EIO", "EDQUOT", "EEXIST")
NAMING = ("open", "link")  # calls that may find that a name is taken
OLD = b"what was there before"
ROW = {"path": "x"}
NONE = words_of("none")


def dng(path):
    scene = np.full((8, 8, 3), 0.4, np.float32)
    frame = cg2raw.Sensor("nikon-d40").simulate(scene, illuminant="D65")
    cg2raw.write_dng(path, frame, threads=1)


def plain(path):
    write_atomically(path, b"all that is new" * 1000)


def folder(path):
    write_folder(path, {"a.json": b"new", "b.json": b"new"}, lambda name: True)


def append(path):
    journal.append(path, ROW)


ROUTES = {"dng": dng, "plain": plain, "folder": folder, "journal": append}


def begin(path, route, exists):
    """Put what is there before into place."""
    shutil.rmtree(path.parent)
    path.parent.mkdir()
    if not exists:
        return
    if route == "folder":
        path.mkdir()
        (path / "a.json").write_bytes(OLD)
    else:
        path.write_bytes(OLD)
        path.chmod(0o666)  # which the umask forbids


def contents(path):
    """Return {relative path: bytes} of a file or folder."""
    if path.is_dir():
        return {str(p.relative_to(path)): p.read_bytes() for p in path.rglob("*")}
    return {"": path.read_bytes()} if path.exists() else {}


def state_of(path, before, after, error):
    """Return "old", "new", "aside" for old where the message says, or "else"."""
    found = contents(path)
    if found in (before, after):
        return "old" if found == before else "new"
    aside = list(path.parent.glob(".cg2raw.*/old"))
    if not found and len(aside) == 1 and error and str(aside[0]) in error:
        return "aside" if contents(aside[0]) == before else "else"
    return "else"


def main(place, log, route):
    path, log = Path(place) / "shot.dng", Path(log)
    write = ROUTES[route]
    states = (True,) if route == "journal" else (True, False)
    for exists in states:
        begin(path, route, exists)
        before = contents(path)
        write(str(path))
        after = contents(path)
        for call, number, sticky, tmpfile in itertools.product(
            CALLS, NUMBERS, "01", "01"
        ):
            if number == "EEXIST" and call not in NAMING:
                continue
            for nth in itertools.count(1):
                begin(path, route, exists)
                log.unlink(missing_ok=True)
                case = f"{exists} {call} {number} {sticky} {tmpfile} {nth}"
                begin_fault(
                    words_of(
                        call, getattr(errno, number), nth, int(sticky), tmpfile == "0"
                    )
                )
                error = None
                try:
                    write(str(path))
                except (ValueError, OSError) as caught:
                    error = str(caught)
                begin_fault(NONE)
                if not log.exists():
                    break
                state = state_of(path, before, after, error)
                left = sorted(str(p.name) for p in path.parent.iterdir())
                print(json.dumps([case, error, state, left]), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])

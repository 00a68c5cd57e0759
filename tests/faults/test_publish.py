# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Whatever the system refuses, and when: a file is as before, or whole and new."""

import json
import os
import subprocess
import sys
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from conftest import oiiotool_runner
from faults.injector import Injector
from images import attributes, write_image
from tiers import first_fast

CASES = Path(__file__).with_name("publish_cases.py")
NEW_FILE = {"open", "pwrite", "fsync", "close", "link", "rename", "fchmod"}


@pytest.fixture
def injector(library, tmp_path):
    """Return an Injector of faults in a folder that is empty."""
    (tmp_path / "out").mkdir()
    return Injector(library, tmp_path / "out", tmp_path)


def cases_of(injector, route, repository):
    """Return [case, error, state, names that are left] of each failed call."""
    environment = {
        **os.environ,
        "LD_PRELOAD": str(injector.library),
        "FAULT_UNDER": injector.folder,
        "FAULT_LOG": str(injector.log),
        "CG2RAW_PROFILE_PATH": str(repository / "plugins/profiles"),
        "PYTHONPATH": os.pathsep.join(path for path in sys.path if path),
    }
    command = [sys.executable, CASES, injector.folder, injector.log, route]
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


@pytest.mark.parametrize("route", ["dng", "plain", "folder", "journal"])
def test_each_failed_call_leaves_the_old_or_the_new(injector, route, repository):
    cases = cases_of(injector, route, repository)
    fired = Counter(case.split()[1] for case, *_ in cases)
    expected = {
        "dng": NEW_FILE,
        "plain": NEW_FILE,
        "folder": NEW_FILE - {"fchmod"},
        "journal": {"open", "write", "close"},
    }[route]
    assert set(fired) == expected
    wrong = []
    for case, error, state, left in cases:
        # Without an error the new file must stand; with one either, but nothing else.
        whole = state == "new" if error is None else state in ("old", "new", "aside")
        if error is not None and "shot.dng" not in error:
            whole = False
        if set(left) - {"shot.dng"} and state != "aside":
            whole = False
        if state == "aside" and (route != "folder" or "rename" not in case):
            whole = False
        if not whole:
            wrong.append((case, error, state, left))
    assert wrong == []
    assert len(cases) > 30
    if route in ("dng", "plain"):
        taken = {case: error for case, error, *_ in cases if finds_a_name_taken(case)}
        assert taken and set(taken.values()) == {None}  # another name was tried


def finds_a_name_taken(case):
    """Return whether a case is of one temporary name that another file has."""
    _, call, number, sticky, no_tmpfile, _ = case.split()
    named = call == "link" or (call == "open" and no_tmpfile == "1")
    return number == "EEXIST" and sticky == "0" and named


CALLS = ("rename", "pwrite", "fsync", "close", "link")
BY_SYSTEM = first_fast([("oiio-system", call) for call in CALLS], 1)


@pytest.mark.parametrize(
    ("name", "call"), [*BY_SYSTEM, *(("oiio-wheel", call) for call in CALLS)]
)
def test_oiiotool_keeps_an_older_file(injector, tmp_path, name, call):
    run = oiiotool_runner(name)
    exr = write_image(tmp_path / "in.exr", np.full((64, 64, 3), 0.4, np.float32))
    out = Path(injector.folder) / "shot.dng"
    words = [exr, *attributes(sensor="nikon-d40", illuminant="D65"), "-o", out]
    run(*words)
    new = out.read_bytes()
    for tmpfile in (True, False):
        out.write_bytes(b"old")
        faults = injector.environment(call, 28, tmpfile=tmpfile)
        done = run(*words, env=faults, check=False)
        assert [path.name for path in out.parent.iterdir()] == ["shot.dng"]
        if done.returncode:
            assert out.read_bytes() == b"old"
            assert "No space left on device" in done.stdout + done.stderr
        else:
            assert out.read_bytes() == new
        if injector.fired and call in ("pwrite", "fsync"):
            assert done.returncode != 0

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Memory that a program keeps for the next arrays."""

import platform
import subprocess
import sys

import pytest

from cg2raw import system

ARRAYS, PAGES = 50, 2048  # of 8 MiB each
PROGRAM = f"""
import resource
import sys
import numpy as np
from cg2raw.system import keep_freed_memory

if sys.argv[1] == "keep":
    keep_freed_memory()
before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
for _ in range({ARRAYS}):
    first = np.ones({PAGES} * 512)
    second = first + 1
    del first, second
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""


def pages_cleared(mode):
    """Return how many pages the system gave to a process that makes arrays again and
    again."""
    command = [sys.executable, "-c", PROGRAM, mode]
    return int(subprocess.run(command, check=True, capture_output=True).stdout)


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="is glibc's")
def test_pages_that_were_freed_are_taken_again():
    assert pages_cleared("plain") > 4 * pages_cleared("keep")


def test_other_libraries_stay_as_they_are(monkeypatch):
    monkeypatch.setattr(platform, "libc_ver", lambda: ("", ""))
    monkeypatch.setattr(system.ctypes, "CDLL", None)  # would fail
    system.keep_freed_memory()

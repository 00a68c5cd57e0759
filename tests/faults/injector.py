# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""System calls that fail: injector.c, compiled, and the variables that ask for it."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

SOURCE = Path(__file__).with_name("injector.c")


def compiled(folder):
    """Return the path of the injector, compiled into a folder, or skip the test."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        pytest.skip("no C compiler")
    library = folder / "injector.so"
    command = [compiler, "-shared", "-fPIC", "-O1", SOURCE, "-o", library, "-ldl"]
    subprocess.run(command, check=True)
    return library


class Injector:
    """Environments in which a call on files of one folder fails.

    folder : of the files. scratch : another one, for what the injector needs."""

    def __init__(self, library, folder, scratch):
        self.library, self.folder = library, os.path.realpath(folder)
        self.log = scratch / "faults.log"

    def environment(self, call, number, nth=1, sticky=False, tmpfile=True):
        """Return the variables that make the nth call fail with an errno."""
        self.log.unlink(missing_ok=True)
        return {
            "LD_PRELOAD": str(self.library),
            "FAULT_UNDER": self.folder,
            "FAULT_CALL": call,
            "FAULT_ERRNO": str(number),
            "FAULT_NTH": str(nth),
            "FAULT_STICKY": str(int(sticky)),
            "FAULT_NO_TMPFILE": str(int(not tmpfile)),
            "FAULT_LOG": str(self.log),
        }

    @property
    def fired(self):
        """Return whether a call was made to fail."""
        return self.log.exists()

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What is promised of a command that a fault has met, and whether it was kept."""

import os
import signal
from dataclasses import dataclass

LONGEST = 2000  # letters of a message
# What no user is to see.
RAW = ("Traceback", "terminate called", "std::", "core dumped", "incompatible function")


@dataclass
class Ended:
    """How a process ended: None for one that had to be killed; what it printed."""

    status: int | None
    text: str

    @property
    def code(self):
        """Return the exit code, that of shells for a signal."""
        if self.status is None:
            return None
        code = os.waitstatus_to_exitcode(self.status)
        return code if code >= 0 else 128 - code


@dataclass
class Known:
    """What is in the folder before, and after a run without a fault."""

    before: dict[str, bytes]
    after: dict[str, bytes]
    folder: str
    grows: bool = False  # a folder of it may be made in part


def contents(folder, without=()):
    """Return {path below a folder: bytes} of all files, and of folders None."""
    return {
        path.relative_to(folder).as_posix(): None
        if path.is_dir()
        else path.read_bytes()
        for path in folder.rglob("*")
        if path.relative_to(folder).parts[0] not in without
    }


def faults_of(ended, found, known, is_silent=False):
    """Return what is wrong, in words; empty for nothing.

    found : contents of the folder afterwards. is_silent : there was no memory for a
    message."""
    wrong = []
    if ended.status is None:
        return ["hangs"]
    if os.WIFSIGNALED(ended.status):
        wrong.append(f"killed by {signal.Signals(os.WTERMSIG(ended.status)).name}")
    wrong += [f"says {word}" for word in RAW if word in ended.text]
    failed = ended.code != 0
    if failed and len(ended.text) > LONGEST:
        wrong.append(f"says {len(ended.text)} letters")
    if failed and not is_silent:
        if not ended.text.strip():
            wrong.append(f"exit code {ended.code} without a word")
        elif known.folder not in ended.text:
            wrong.append("names no path")
    return wrong + states_of(found, known, failed, ended.text)


def states_of(found, known, failed, text):
    """Return what is wrong with the files."""
    wrong = []
    for name in sorted(found.keys() - known.before.keys() - known.after.keys()):
        if not is_aside(name, found, known, text):
            wrong.append(f"leaves {name}")
    for name in sorted(known.before.keys() | known.after.keys()):
        allowed = [known.after.get(name, "none")]
        if failed:
            allowed.append(known.before.get(name, "none"))
        if found.get(name, "none") not in allowed and not set_aside(text, found):
            state = "is missing" if name not in found else "is neither old nor new"
            wrong.append(f"{name} {state}")
    return wrong + ([] if known.grows else parts_of(found, known))


def parts_of(found, known):
    """Return which new folders are there without all that is to be in them."""
    new = [name for name, data in known.after.items() if data is None]
    return [
        f"leaves a part of {folder}"
        for folder in sorted(set(new) & found.keys() - known.before.keys())
        if any(n.startswith(f"{folder}/") and n not in found for n in known.after)
    ]


def set_aside(text, found):
    """Return whether the message says where what was there is now, and it is."""
    return "what was there is in" in text and any(
        name.startswith(".cg2raw.") for name in found
    )


def is_aside(name, found, known, text):
    """Return whether a name is of what could not be moved back, as the message says."""
    return name.startswith(".cg2raw.") and set_aside(text, found)

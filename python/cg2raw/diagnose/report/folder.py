# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The folder of a report: written whole or not at all, without loss of other files."""

import json
import os
from pathlib import Path

from cg2raw.diagnose.diagnosis import Diagnosis
from cg2raw.diagnose.report.verdict_json import verdict_json
from cg2raw.interrupts import scratch_folder
from cg2raw.io.atomic_file import write_atomically, write_folder

VERDICT, PROFILE = "verdict.json", "profile.json"


def check_folder(path: str, force: bool = False) -> None:
    """Raise ValueError unless a report may go to @path: a new folder, or a report's.

    force : among other files."""
    target = os.path.realpath(path)
    parent = os.path.dirname(target)
    if not os.path.isdir(parent):
        raise ValueError(f"-o {path}: there is no folder {parent}; make it first")
    if os.path.lexists(target) and not os.path.isdir(target):
        raise ValueError(f"-o {path}: is a file; name a folder")
    if force or not os.path.isdir(target):
        return
    foreign = sorted(set(os.listdir(target)) - files_of_report(target))
    if foreign:
        raise ValueError(
            f"-o {path}: holds {foreign[0]}, which is of no report; name another "
            "folder, or add --overwrite to write among its files"
        )


def files_of_report(folder: str) -> set[str]:
    """Return the names that the report in a folder says it wrote; may be none."""
    try:
        with open(os.path.join(folder, VERDICT), encoding="utf-8") as file:
            fields = json.load(file)
        return {VERDICT, *map(str, fields["files"])}
    except (OSError, ValueError, KeyError, TypeError):
        return set()


def write_report_folder(
    diagnosis: Diagnosis, path: str, force: bool = False
) -> list[str]:
    """Write all files of a report; return their names.

    A report that is there is replaced as a whole. force : write among other files,
    which stay. Raises ValueError, OSError; what was there is then as it was, but with
    force each file for itself."""
    from cg2raw.diagnose.report import write_report

    check_folder(path, force)
    with scratch_folder("cg2raw.") as name:
        drawn = Path(name) / "report"
        write_report(diagnosis, drawn)
        files = {file.name: file.read_bytes() for file in sorted(drawn.iterdir())}
    if diagnosis.profile_json:
        files[PROFILE] = diagnosis.profile_json.encode()
    names = sorted([*files, VERDICT])
    files[VERDICT] = verdict_json(diagnosis, names).encode()
    if force and os.path.isdir(path):
        for file, data in files.items():
            write_atomically(os.path.join(path, file), data)
    else:
        ours = files_of_report(os.path.realpath(path))
        write_folder(path, files, ours.__contains__)
    return names

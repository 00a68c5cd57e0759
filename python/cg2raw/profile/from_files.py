# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Make a profile from a camera's RAW files."""

import json
import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

from cg2raw import _core
from cg2raw.io.libraw import is_dng
from cg2raw.profile import from_raw_files

GIVEN = "given by who made the profile"
# How notes of the core begin that say what a profile lacks. The report says it of every
# profile, and of the finished one: what options add is not missing.
LACKS = (
    "fewer than 3 distinct neutrals",
    "noise is known at ISO",
    "NoiseProfile (51041) with an ISO is in none",
    "ColorMatrix2 (50722) is missing",
)


class BadFiles(ValueError):
    """Some files cannot be used; reasons has one line for each."""

    def __init__(self, reasons: list[str], count: int) -> None:
        self.reasons = reasons
        super().__init__(
            f"none of the {count} files can be used"
            if len(reasons) == count
            else f"{len(reasons)} of {count} files cannot be used; --skip-bad leaves "
            "them out"
        )


@dataclass
class Made:
    """A profile under construction, and what was noticed on the way."""

    fields: dict[str, Any]
    kind: str  # "DNG", "RAW" or "spectral sensitivities"
    files: int = 0  # that went in
    notes: list[str] = field(default_factory=list)
    skipped: list[str] = field(default_factory=list)  # reasons, one line each


def profile_from_files(
    paths: Sequence[str],
    *,
    id: str = "",
    make: str = "",
    model: str = "",
    cfa: str = "",
    skip_bad: bool = False,
    progress: Callable[[Sequence[str]], Iterable[str]] = lambda items: items,
) -> Made:
    """Return what RAW files of one camera, DNGs or others, make: a Made.

    id, make, model : stand in for those of the files.
    cfa : of the sensor whose DNGs are demosaicked (LinearRaw); a mosaic says its own.
    skip_bad : skip unreadable files, and say which.
    progress : wraps the paths while they are read.
    Raises BadFiles, or ValueError if the files are not of one camera and kind."""
    paths, notes = distinct(paths)
    dng = is_dng(paths[0])
    for path in paths:
        if is_dng(path) != dng:
            raise ValueError(
                f"{path}: is not of the kind of {paths[0]}; give DNGs or the camera's "
                "own RAW files, not both"
            )
    if cfa and not dng:
        raise ValueError(f"{paths[0]}: says its own CFA: leave --cfa out")

    def read(path: str) -> Any:
        if dng:
            return _core.read_dng_metadata(path, cfa)
        return from_raw_files.read(path, make, model)

    good, reasons = read_all(read, progress(paths))
    if reasons and (not skip_bad or not good):
        raise BadFiles(reasons, len(paths))
    made = from_dngs if dng else from_raw_files.profile_from_raw_files
    fields, found = made(good, id)
    fields = renamed(fields, make=make, model=model)
    kind = "DNG" if dng else "RAW"
    return Made(fields, kind, len(good), notes + found, reasons)


def distinct(paths: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return (paths without repeats, notes)."""
    kept = {os.path.realpath(path): path for path in reversed(paths)}
    repeats = len(paths) - len(kept)
    notes = [f"{repeats} files given more than once count once"] if repeats else []
    return list(reversed(kept.values())), notes


def read_all(
    read: Callable[[str], Any], paths: Iterable[str]
) -> tuple[list[Any], list[str]]:
    """Return (what was read, reasons why the rest was not)."""
    good, reasons = [], []
    for path in paths:
        try:
            if os.path.isdir(path):
                raise ValueError(f"{path}: is a folder; give its files, {path}/*.dng")
            good.append(read(path))
        except OSError as error:
            reasons.append(f"{path}: {error.strerror or error}")
        except ValueError as error:
            reasons.append(str(error))
    return good, reasons


def from_dngs(
    metadata: list[_core.DngMetadata], id: str
) -> tuple[dict[str, Any], list[str]]:
    """Return (fields, notes) of DNGs of one camera."""
    profile, notes = _core.profile_from_dngs(metadata, id)
    fields = json.loads(profile.to_json())
    fields["sources"] = {
        key: text
        for key, text in fields["sources"].items()
        if not key.startswith("note ")
    }
    return fields, [note for note in notes if not note.startswith(LACKS)]


def with_notes(made: Made) -> dict[str, Any]:
    """Return the fields of a Made profile, its notes among their sources."""
    notes = {f"note {number}": note for number, note in enumerate(made.notes, 1)}
    return {**made.fields, "sources": {**made.fields["sources"], **notes}}


def renamed(fields: dict[str, Any], **names: str) -> dict[str, Any]:
    """Return @fields with those make and model that are not empty, and their source."""
    names = {name: text for name, text in names.items() if text}
    sources = {**fields["sources"], **dict.fromkeys(names, GIVEN)}
    return {**fields, **names, "sources": sources}

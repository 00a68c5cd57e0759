# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Frozen suites: files of what each set hides, which every diagnosis has to answer.

A line of SUITE.csv is one set: its number and seed, what decides it, and what is hidden
at which strength (unit: synthetic.strengths.KINDS). The parameters that are drawn
beside a strength, the scenes and the noise follow from the seed. seals.json has the
sha256 of the frames of each suite's first sets, in which each effect is hidden once."""

import csv
import hashlib
import json
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

from studies.diagnose.real import RealCase, manifest_of
from studies.diagnose.suites import OF_SCENES, AnyCase, Case, cases

FOLDER = Path(__file__).with_name("frozen")
SEALS = FOLDER / "seals.json"
SEED = 31415
SIZES = {
    "single": 700,
    "pairs": 100,
    "triples": 50,
    "none": 1000,
    "low-none": 200,
    "nine": 60,
    "real": 100,
    "unknown": 71,
    "nuisance-none": 400,
}
SEALED = {"single": 35, "unknown": 5}  # first sets; of others one
FIELDS = ("number", "seed", "decided_by", "hidden")
DARKS, SCENES = "darks and flats", "scenes"


def decided_by(suite: str, hidden: Iterable[str]) -> str:
    """Return which captures show what a set of a suite hides."""
    of_scenes = bool(OF_SCENES & set(hidden)) or suite.startswith("nuisance")
    return SCENES if of_scenes else DARKS


def row(case: AnyCase) -> dict[str, str]:
    """Return the line of a case."""
    hidden = " ".join(f"{name}={value!r}" for name, value in case.strengths.items())
    shown_by = decided_by(case.suite, case.strengths)
    values = (str(case.number), str(case.seed), shown_by, hidden)
    return dict(zip(FIELDS, values, strict=True))


def drawn(suite: str, captures: Path | None = None) -> list[AnyCase]:
    """Return what the generator makes of a suite, in the order of its file: every
    effect once before any comes again."""
    found, seen = cases(suite, SEED, captures=captures), Counter[str]()
    turns = {}
    for case in found:
        turns[case.number] = seen[" ".join(case.strengths)] if suite == "single" else 0
        seen.update([" ".join(case.strengths)])
    return sorted(found, key=lambda case: turns[case.number])[: SIZES[suite]]


def freeze(captures: Path | None) -> list[str]:
    """Write the files of all suites; return the names. captures : manifest of the real
    frames, without which that suite's file stays as it is."""
    suites = [suite for suite in SIZES if suite != "real" or captures]
    FOLDER.mkdir(exist_ok=True)
    seals = json.loads(SEALS.read_text()) if SEALS.exists() else {}
    for suite in suites:
        sets = drawn(suite, captures if suite == "real" else None)
        with (FOLDER / f"{suite}.csv").open("w", newline="") as file:
            writer = csv.DictWriter(file, FIELDS, lineterminator="\n")
            writer.writeheader()
            writer.writerows(row(case) for case in sets)
        if suite != "real":  # whose frames are not part of the project
            seals[suite] = seal(sets[: SEALED.get(suite, 1)])
    SEALS.write_text(json.dumps(seals, indent=1, sort_keys=True) + "\n")
    return suites


def frozen(suite: str, captures: Path | None = None) -> list[AnyCase]:
    """Return the sets that a file says. captures : as of freeze.

    Raises ValueError for a line that is not one, and OSError without a file."""
    path = FOLDER / f"{suite}.csv"
    found: list[AnyCase] = []
    with path.open(newline="") as file:
        for line, values in enumerate(csv.DictReader(file), 2):
            try:
                found.append(_case(suite, values, captures))
            except (KeyError, ValueError) as error:
                raise ValueError(f"{path}:{line}: {error}") from error
    return found


def _case(suite: str, values: dict[str, str], captures: Path | None) -> AnyCase:
    number, own = int(values["number"]), int(values["seed"])
    pairs = (word.split("=") for word in values["hidden"].split())
    strengths = {name: float(value) for name, value in pairs}
    if captures is None:
        return Case(suite, number, own, strengths)
    return RealCase(suite, number, own, strengths, manifest_of(captures))


def seal(sets: Iterable[AnyCase]) -> str:
    """Return the sha256 of the frames of sets."""
    total = hashlib.sha256()
    for case in sets:
        for capture in case.captures()[0].captures:
            total.update(capture.name.encode() + capture.raw().tobytes())
    return total.hexdigest()

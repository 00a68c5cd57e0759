# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What tables are made of: summaries of results.json, study by study, and the committed
file of them, which stands beside the page.

Of errors of frames: their Summary and number. Of (draws, frames): each draw's Summary
and, of a study's first measure, each frame's mean, by which differences have their
standard errors. Each study says by what it was made: no table mixes two versions."""

import json
import re
from collections.abc import Mapping
from dataclasses import astuple
from pathlib import Path
from typing import Any

import numpy as np

from studies.places import ROOT
from studies.results import Results, draws_of
from studies.tasks.angles import Summary, summary

COMMITTED = ROOT / "docs" / "evidence.json"
FIRST = ("difference", "psnr")  # measures whose frames are kept, if none is before
DECIMALS = 4
UNREDUCED = ("content",)  # a number a draw
Summaries = dict[str, dict[str, Any]]  # study's entry: "made by", "cameras"


def summaries(results: Results) -> Summaries:
    """Return the Summaries of all entries of results."""
    return {
        name: {
            "made by": study["made by"],
            "cameras": {
                camera: kept["entry"]
                if name.partition(",")[0] in UNREDUCED
                else reduced(kept["entry"])
                for camera, kept in study["cameras"].items()
            },
        }
        for name, study in results.items()
    }


def reduced(entry: Any) -> Any:
    """Return what is kept of an entry: of lists of frames, and of draws of frames."""
    if isinstance(entry, Mapping):
        first = next((name for name in FIRST if name in entry), None)
        return {
            name: reduced(part) if first in (None, name) else without_frames(part)
            for name, part in entry.items()
        }
    if entry is None or not isinstance(entry[0], list):
        return entry and {"summary": rounded(entry), "frames": len(entry)}
    means = np.mean(entry, axis=0).round(DECIMALS)
    return {**without_frames(entry), "frames": means.tolist()}


def without_frames(draws: Any) -> Any:
    """Return the Summary of each draw; of frames, that of them all."""
    if not isinstance(draws[0], list):
        return reduced(draws)
    return {"seeds": [rounded(frames) for frames in draws]}


def rounded(frames: Any) -> list[float]:
    """Return the Summary of values (n,) as a list."""
    found = astuple(summary(np.array(frames, float)))
    return [round(value, DECIMALS) for value in found]


def summary_of(kept: Mapping[str, Any]) -> Summary:
    """Return the Summary of what is kept of frames."""
    return Summary(*kept["summary"])


def draws_in(entry: Any) -> int:
    """Return how many draws a reduced entry has; of frames alone, 0."""
    while isinstance(entry, Mapping) and "seeds" not in entry:
        if "summary" in entry or not entry:
            return 0
        entry = next(iter(entry.values()))
    return draws_of(entry["seeds"] if isinstance(entry, Mapping) else entry)


def read_committed(path: Path = COMMITTED) -> Summaries:
    """Return the Summaries of a file; {} without it. Raises ValueError naming it."""
    if not path.exists():
        return {}
    try:
        found = json.loads(path.read_text())
        return {
            name: {**study, "cameras": dict(study["cameras"])}
            for name, study in found["studies"].items()
        }
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"{path}: is no file of summaries: {error}") from None


def joined(before: Summaries, found: Summaries) -> Summaries:
    """Return summaries with those that were found in place of earlier ones.

    Cameras of a study are kept if all that it was made by is the same."""
    kept = dict(before)
    for name, study in found.items():
        earlier = before.get(name, {})
        same = earlier.get("made by") == study["made by"]
        cameras = {**(earlier["cameras"] if same else {}), **study["cameras"]}
        kept[name] = {**study, "cameras": cameras}
    return kept


def committed_text(found: Summaries) -> str:
    """Return the text of a file of summaries: a line for each list of numbers."""
    text = json.dumps({"studies": found}, sort_keys=True, indent=1)
    return re.sub(r"\[[^][{}]*\]", lambda part: "".join(part[0].split()), text) + "\n"

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Tables of studies 2 and 3: each source beside the camera's own frames, and pairs of
sources that differ in one thing."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from studies.sources.exposures import EXPOSURES, MATCH
from studies.sources.mosaics import ARRAYS, FILES
from studies.tables import table
from studies.tables_paired import REAL, error_rows, extent, gain_rows
from studies.tasks.paired import Kept

# condition: source: measure: of (draws, frames)
Entry = Mapping[str, Mapping[str, Mapping[str, Kept]]]


@dataclass(frozen=True)
class Measure:
    """A column of cells, and how it is written."""

    name: str
    digits: int
    more_is_better: bool


MEASURES = {
    "difference": Measure("CIEDE2000", 2, False),
    "psnr": Measure("PSNR, dB", 2, True),
    "ssim": Measure("SSIM", 4, True),
}
PAIRS = (
    *((f"ours, {name}", f"upi, {name}") for name in (*EXPOSURES, MATCH)),
    ("ours, match, global gains", "upi, match, global gains"),
    ("ours, match", "ours, own"),
    ("ours, match", "ours, match, paper"),
    ("ours, match", "no matrix, match"),
    ("ours, match", "translation, our lights"),
    ("ours, match", "ours, match, world's scenes"),
    (FILES, ARRAYS),
    ("ours, match", ARRAYS),
)


def night_tables(found: Mapping[str, Entry], title: str) -> str:
    """Return the tables of {camera: entry}, two for each condition of the entries."""
    entries = list(found.values())
    conditions = list(entries[0])
    measures = list(entries[0][conditions[0]][REAL])
    size = extent(entry[conditions[0]][REAL][measures[0]] for entry in entries)
    said = "; ".join(MEASURES[name].name for name in measures)
    parts = [
        f"### {title}, {size}\n\nMeans: {said}. Then differences of "
        f"{MEASURES[measures[0]].name} (SE over draws and frames); beats: by more than "
        "3 SE."
    ]
    for condition in conditions:
        of_cameras = [entry[condition] for entry in entries]
        parts += [
            table([condition, *found], means_of(of_cameras, measures)),
            table(
                [f"{condition}: difference", *found],
                differences(of_cameras, measures[0]),
            ),
        ]
    return "\n\n".join(parts)


def means_of(
    cameras: Sequence[Mapping[str, Mapping[str, Kept]]], measures: Sequence[str]
) -> list[list[str]]:
    """Return a row for each source, of all measures in one cell a camera."""

    def cell(kept: Mapping[str, Kept] | None) -> str:
        if kept is None:
            return ""
        return "; ".join(
            f"{np.mean(kept[name]['seeds'], axis=0)[0]:.{MEASURES[name].digits}f}"
            for name in measures
        )

    return [
        [source, *(cell(camera.get(source)) for camera in cameras)]
        for source in all_of(cameras)
    ]


def all_of(cameras: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the sources that one camera has at least, those of the most first."""
    return list(dict.fromkeys(s for of in sorted(cameras, key=len)[::-1] for s in of))


def differences(
    cameras: Sequence[Mapping[str, Mapping[str, Kept]]], measure: str
) -> list[list[str]]:
    """Return a row for each source less real, then for each of PAIRS."""
    values = [
        {source: measures[measure] for source, measures in camera.items()}
        for camera in cameras
    ]
    there = all_of(values)
    pairs = [(source, REAL) for source in there if source != REAL]
    pairs += [pair for pair in PAIRS if set(pair) <= set(there)]
    how = MEASURES[measure]
    if how.more_is_better:
        return gain_rows(pairs, values, how.digits)
    return error_rows(pairs, values)

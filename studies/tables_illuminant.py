# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Tables of study 1: errors of each source, and which differences are sure."""

from collections.abc import Mapping, Sequence
from dataclasses import astuple
from itertools import combinations

import numpy as np

from studies.tables import numbers, table
from studies.tables_paired import (
    BASELINES,
    FLOOR,
    OWN,
    REAL,
    error_rows,
    extent,
    of_errors,
)
from studies.tasks.angles import Summary, summary
from studies.tasks.paired import BEATS, difference, share_left

Errors = Mapping[str, Sequence[Sequence[float]]]  # source: (seeds, frames), degrees
OTHERS = ("ours, paper", "ours, spectral", OWN)  # ours is compared with each
LEFT = 0.3  # the goal: of a baseline's gap to real


def illuminant_tables(
    found: Mapping[str, Errors],
    compared: Sequence[str] = (OWN,),
    title: str = "Illuminant",
) -> str:
    """Return the tables of {camera: errors}. compared : sources, each with others."""
    first = next(iter(found.values()))
    size = extent((errors[REAL] for errors in found.values()), "seeds")
    rows = [
        [source, *(cell(np.array(found[camera][source])) for camera in found)]
        for source in first
    ]
    return (
        f"### {title}, {size}\n\n"
        "Degrees: mean +- sd over seeds; median; mean of the best and of the worst "
        f"quarter.\n\n{table(['trained on', *found], rows)}\n\n"
        "Paired differences, degrees (SE over seeds and frames); beats: by more than "
        f"{BEATS:g} SE.\n\n" + "\n\n".join(sure(found, own) for own in compared)
    )


def cell(errors: np.ndarray) -> str:
    """Return a source's errors (seeds, frames) in one cell."""
    of_seeds = [astuple(summary(row)) for row in errors]
    found = Summary(*np.mean(of_seeds, axis=0).tolist())
    spread = errors.mean(axis=1).std(ddof=1)
    mean, *others = numbers(found).split("; ")
    return "; ".join([f"{mean} +- {spread:.2f}", *others])


def sure(found: Mapping[str, Errors], own: str) -> str:
    """Return the differences that the goals are about."""
    pairs = [
        (own, REAL),
        (FLOOR, REAL),
        *((own, baseline) for baseline in BASELINES),
        *((own, other) for other in OTHERS if other != own),
    ]
    there = set(next(iter(found.values())))
    pairs = [pair for pair in pairs if set(pair) <= there]
    rows = error_rows(pairs, list(found.values()))
    rows += [
        [f"share of the gap of {baseline} left (goal {LEFT})"]
        + [
            f"{share_left(errors[own], errors[baseline], errors[REAL]):.2f}"
            for errors in found.values()
        ]
        for baseline in BASELINES
    ]
    return table(["difference", *found], rows)


def longer_tables(
    illuminant: Mapping[str, Errors], longer: Mapping[str, Errors]
) -> str:
    """Return how differences of sources change if training is longer.

    Both : {camera: errors}; of illuminant the first seeds are compared."""
    cameras = [camera for camera in longer if camera in illuminant]
    seeds = len(longer[cameras[0]][REAL])
    rows = []
    sources = list(longer[cameras[0]])
    for other, one in combinations(sources, 2):
        cells = []
        for camera in cameras:
            before, after = (
                difference(e[camera][one][:seeds], e[camera][other][:seeds])
                for e in (illuminant, longer)
            )
            cells.append(f"{of_errors(before)}; {of_errors(after)}")
        rows.append([f"{one} - {other}", *cells])
    return (
        f"Is training long enough? Differences as above of {seeds} seeds, then those "
        f"after longer training.\n\n{table(['difference', *cameras], rows)}"
    )

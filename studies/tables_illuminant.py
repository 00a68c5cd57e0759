# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Tables of study 1: errors of each source, and which differences are sure."""

from collections.abc import Mapping, Sequence

import numpy as np

from studies.tables import numbers, table
from studies.tables_paired import (
    BASELINES,
    FLOOR,
    OWN,
    REAL,
    error_rows,
    extent,
)
from studies.tasks.angles import Summary
from studies.tasks.paired import BEATS, Kept, means, share_left

Errors = Mapping[str, Kept]  # source: of (seeds, frames), degrees
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
        [source, *(cell(found[camera][source]) for camera in found)] for source in first
    ]
    return (
        f"### {title}, {size}\n\n"
        "Degrees: mean +- sd over seeds; median; mean of the best and of the worst "
        f"quarter.\n\n{table(['trained on', *found], rows)}\n\n"
        "Paired differences, degrees (SE over seeds and frames); beats: by more than "
        f"{BEATS:g} SE.\n\n"
        + "\n\n".join(sure(found, own) for own in compared if own in first)
    )


def cell(errors: Kept) -> str:
    """Return a source's errors (seeds, frames) in one cell."""
    found = Summary(*np.mean(errors["seeds"], axis=0).tolist())
    spread = means(errors)[0].std(ddof=1)
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


def light_tables(
    with_leds: Mapping[str, Mapping[str, Errors]],
    without: Mapping[str, Mapping[str, Errors]],
) -> str:
    """Return the mean errors of test frames by their lights, a table for each camera.

    Both : {lights: {camera: errors}}, of training with LEDs and without."""
    lights = list(with_leds)
    cameras = dict.fromkeys(name for of in with_leds.values() for name in of)
    parts = [
        "#### By the light\n\nMean degrees of test frames by the colour temperature of "
        "their main light, and of frames under LEDs alone; *no LEDs*: none in training."
    ]
    for camera in cameras:
        rows = []
        for found, said in ((with_leds, ""), (without, ", no LEDs")):
            entries = [found.get(of, {}).get(camera, {}) for of in lights]
            rows += [
                [source + said, *(mean_degrees(entry, source) for entry in entries)]
                for source in dict.fromkeys(s for entry in entries for s in entry)
            ]
        parts.append(table([camera, *lights], rows))
    return "\n\n".join(parts)


def mean_degrees(entry: Errors, source: str) -> str:
    """Return a source's mean error in one cell; none without frames of such lights."""
    return f"{means(entry[source])[0].mean():.2f}" if source in entry else ""

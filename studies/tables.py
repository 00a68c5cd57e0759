# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Tables in Markdown: text to the left, numbers to the right."""

from collections.abc import Mapping, Sequence
from dataclasses import astuple
from typing import Any

from studies.summaries import summary_of
from studies.tasks.angles import Summary
from studies.tasks.classical import PUBLISHED, over_cameras

Errors = Mapping[str, Mapping[str, Any]]  # method or measure: what is kept of frames
MEASURES = {"degrees": "deg", "difference": "CIEDE2000"}
RATIOS = (  # of mean angles, each with its goal
    ("ours, dng", "ours, paper", 0.7),
    ("ours, dng", "upi's matrices", 1.0),
    ("ours, spectral", "ours, dng", 0.6),
)


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table of a head and rows, alike in length."""
    lines = [head, ["---"] + ["---:"] * (len(head) - 1), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def numbers(found: Summary) -> str:
    """Return a Summary in one cell."""
    return "; ".join(f"{value:.2f}" for value in astuple(found))


def classical_tables(found: Mapping[str, Errors], within: float) -> str:
    """Return grey world and shades of grey beside what was published.

    found : {camera: {method: errors}}. within : of the published numbers, allowed."""
    of_cameras = {
        camera: {method: summary_of(errors[method]) for method in PUBLISHED}
        for camera, errors in found.items()
    }
    rows = [
        [camera, *(numbers(summaries[method]) for method in PUBLISHED)]
        for camera, summaries in of_cameras.items()
    ]
    together = over_cameras(of_cameras)
    rows.append(["geometric mean", *(numbers(together[m]) for m in PUBLISHED)])
    rows.append(["published, NUS", *(numbers(s) for s in PUBLISHED.values())])
    off = [
        "; ".join(f"{share:+.0%}" for share in departure(together[method], published))
        for method, published in PUBLISHED.items()
    ]
    rows.append([f"departure, {within:.0%} allowed", *off])
    frames = next(iter(next(iter(found.values())).values()))["frames"]
    return (
        f"### Classical methods, {frames} frames a camera\n\n"
        "Degrees: mean; median; mean of the best and of the worst quarter.\n\n"
    ) + table(["camera", *PUBLISHED], rows)


def departure(measured: Summary, published: Summary) -> list[float]:
    """Return each number over the published one, less 1."""
    pairs = zip(astuple(measured), astuple(published), strict=True)
    return [a / b - 1.0 for a, b in pairs]


def colour_tables(found: Mapping[str, Mapping[str, Errors]], kind: str) -> str:
    """Return study 0's errors by method and camera, and its ratios.

    found : {camera: {method: {measure: errors}}}. kind : of the scenes."""
    cameras, names = list(found), sorted(next(iter(found.values())))
    frames = found[cameras[0]][names[0]]["degrees"]["frames"]
    rows = [
        [name, *(means(found[camera][name]) for camera in cameras)] for name in names
    ]
    ratios = [
        [f"{own} / {other} (goal {goal})"]
        + [f"{ratio(found[camera], own, other):.2f}" for camera in cameras]
        for own, other, goal in RATIOS
    ]
    told = " and ".join(MEASURES.values())
    return (
        f"### Colour, {kind}, {frames} frames a camera: mean {told}\n\n"
        f"{table([kind, *cameras], rows)}\n\n"
        f"{table(['mean angle', *cameras], ratios)}"
    )


def means(errors: Errors) -> str:
    """Return the mean of each measure in one cell."""
    return ", ".join(f"{summary_of(errors[name]).mean:.2f}" for name in MEASURES)


def ratio(found: Mapping[str, Errors], own: str, other: str) -> float:
    """Return the mean angle of a method over that of another."""
    one, more = (summary_of(found[name]["degrees"]).mean for name in (own, other))
    return one / more

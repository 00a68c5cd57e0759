# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Rows of paired differences, which all studies of what is learnt have."""

from collections.abc import Callable, Iterable, Mapping, Sequence

from studies.tasks.paired import Difference, Values, difference, means

BySource = Mapping[str, Values]  # source: of (draws, frames)
OWN, REAL, FLOOR = "ours, dng", "real", "real, other scenes"
BASELINES = ("upi, graphics2raw", "upi, camera")


def extent(cameras: Iterable[Values], word: str = "draws") -> str:
    """Return of how much a table is: of the (draws, frames) of each camera.

    word : for draws. Of cameras that have unlike numbers, the least and the most."""
    of = [[len(found) for found in means(values)] for values in cameras]
    draws, frames = zip(*of, strict=True)
    return f"{between(draws)} {word}, {between(frames)} test frames a camera"


def between(counts: Sequence[int]) -> str:
    """Return the range of counts in words."""
    least, most = min(counts), max(counts)
    return f"{least}" if least == most else f"{least} to {most}"


def of_errors(found: Difference) -> str:
    """Return a Difference of errors in one cell."""
    return f"{found.mean:+.2f} ({found.error:.2f})" + beats(found)


def of_gains(found: Difference, digits: int) -> str:
    """Return a Difference of what is better if it is more, other - one, in one cell."""
    return f"{0.0 - found.mean:+.{digits}f} ({found.error:.{digits}f})" + beats(found)


def beats(found: Difference) -> str:
    """Return the word for a difference that is sure."""
    return " beats" if found.beats else ""


def error_rows(
    pairs: Iterable[tuple[str, str]], cameras: Sequence[BySource]
) -> list[list[str]]:
    """Return a row for each pair of sources: of errors, one cell for each camera."""
    return rows(pairs, cameras, lambda one, other: of_errors(difference(one, other)))


def gain_rows(
    pairs: Iterable[tuple[str, str]], cameras: Sequence[BySource], digits: int
) -> list[list[str]]:
    """Return the same of a measure of which more is better, so many digits."""
    return rows(
        pairs,
        cameras,
        lambda one, other: of_gains(difference(other, one), digits),
    )


def rows(
    pairs: Iterable[tuple[str, str]],
    cameras: Sequence[BySource],
    cell: Callable[[Values, Values], str],
) -> list[list[str]]:
    """Return a row for each pair, a cell empty of a camera that lacks one of it."""
    return [
        [f"{one} - {other}"]
        + [
            cell(values[one], values[other]) if {one, other} <= set(values) else ""
            for values in cameras
        ]
        for one, other in pairs
    ]

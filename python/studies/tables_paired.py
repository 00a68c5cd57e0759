# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Rows of paired differences, which all studies of what is learnt have."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from studies.tasks.paired import Difference, difference

Values = Mapping[str, Sequence[Sequence[float]]]  # source: (draws, frames)
OWN, REAL, FLOOR = "ours, dng", "real", "real, other scenes"
BASELINES = ("upi, graphics2raw", "upi, camera")


def of_errors(found: Difference) -> str:
    """Return a Difference of errors in one cell."""
    return f"{found.mean:+.2f} ({found.error:.2f})" + beats(found)


def of_decibels(found: Difference) -> str:
    """Return a Difference of PSNR, whose errors are its negative, in one cell."""
    return f"{-found.mean:+.3f} ({found.error:.3f})" + beats(found)


def beats(found: Difference) -> str:
    """Return the word for a difference that is sure."""
    return " beats" if found.beats else ""


def error_rows(
    pairs: Iterable[tuple[str, str]], cameras: Sequence[Values]
) -> list[list[str]]:
    """Return a row for each pair of sources: of errors, one cell for each camera."""
    return [
        [f"{one} - {other}"]
        + [of_errors(difference(values[one], values[other])) for values in cameras]
        for one, other in pairs
    ]


def decibel_rows(
    pairs: Iterable[tuple[str, str]], cameras: Sequence[Values]
) -> list[list[str]]:
    """Return the same of PSNR in dB, of which more is better."""
    return [
        [f"{one} - {other}"]
        + [
            of_decibels(
                difference(np.negative(values[one]), np.negative(values[other]))
            )
            for values in cameras
        ]
        for one, other in pairs
    ]

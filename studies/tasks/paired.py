# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Differences of two sources over the same seeds and the same test frames."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

# What is kept of values (seeds, frames), and is all that differences need: of each seed
# the Summary's four numbers, and the mean of each frame.
Kept = Mapping[str, Sequence[Any]]
Values = ArrayLike | Kept

BEATS = 3.0  # standard errors, above which one source beats another


@dataclass(frozen=True)
class Difference:
    """A mean, and its standard error over seeds and frames."""

    mean: float
    error: float

    @property
    def beats(self) -> bool:
        """Whether the mean is below 0 by more than BEATS standard errors."""
        return self.mean < -BEATS * self.error


def means(values: Values) -> tuple[np.ndarray, np.ndarray]:
    """Return the means of values (seeds, frames): of each seed, and of each frame."""
    if isinstance(values, Mapping):
        return np.array(values["seeds"])[:, 0], np.array(values["frames"])
    found = np.asarray(values, float)
    return found.mean(axis=1), found.mean(axis=0)


def difference(one: Values, other: Values) -> Difference:
    """Return the Difference one - other of errors (seeds, frames), both at least 2.

    Seeds and frames are drawn alike for both, and both are samples: the variances of
    the means over each are added, so that neither many frames nor many seeds alone make
    a difference sure."""
    seeds, frames = (
        own - others for own, others in zip(means(one), means(other), strict=True)
    )
    variance = seeds.var(ddof=1) / len(seeds) + frames.var(ddof=1) / len(frames)
    return Difference(float(seeds.mean()), math.sqrt(variance))


def share_left(own: Values, baseline: Values, real: Values) -> float:
    """Return which share of a baseline's gap to real a source leaves: 0 is as real."""
    gap = difference(baseline, real).mean
    return difference(own, real).mean / gap if gap else math.nan

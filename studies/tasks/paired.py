# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Differences of two sources over the same seeds and the same test frames."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

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


def difference(one: ArrayLike, other: ArrayLike) -> Difference:
    """Return the Difference one - other of errors (seeds, frames), both at least 2.

    Seeds and frames are drawn alike for both, and both are samples: the variances of
    the means over each are added, so that neither many frames nor many seeds alone make
    a difference sure."""
    found = np.asarray(one, float) - np.asarray(other, float)
    seeds, frames = found.shape
    of_seeds = found.mean(axis=1).var(ddof=1) / seeds
    of_frames = found.mean(axis=0).var(ddof=1) / frames
    return Difference(float(found.mean()), math.sqrt(of_seeds + of_frames))


def share_left(own: ArrayLike, baseline: ArrayLike, real: ArrayLike) -> float:
    """Return which share of a baseline's gap to real a source leaves: 0 is as real."""
    gap = difference(baseline, real).mean
    return difference(own, real).mean / gap if gap else math.nan

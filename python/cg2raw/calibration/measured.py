# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Numbers with their standard errors, and moments and least squares that give them:
without what lies 4 sigma off, and corrected for it."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw.normal import MAD

Array = NDArray[Any]
SIGNIFICANT = 3.0  # standard errors
CUT = 4.0  # sigma beyond which a pixel does not count
# Of a normal distribution, what a cut at 4 sigma leaves of its variance.
LEFT = 1 - 2 * CUT * math.exp(-CUT * CUT / 2) / math.sqrt(2 * math.pi) / math.erf(
    CUT / math.sqrt(2)
)
ROUNDS = 6
ENOUGH = 20_000  # values for a median that only begins


@dataclass(frozen=True)
class Measured:
    """A value with its standard error (one sigma), in a unit.

    Where the value is the root of a variance whose noise was taken off, it is never
    below 0, and its error is that of the variance over twice the value."""

    value: float
    standard_error: float
    unit: str

    def scaled(self, factor: float, unit: str) -> "Measured":
        """Return the value in another unit, of which one of these is @factor."""
        return Measured(self.value * factor, abs(self.standard_error * factor), unit)

    @property
    def stands_out(self) -> bool:
        """Whether the value is more than three standard errors off 0."""
        return abs(self.value) > SIGNIFICANT * self.standard_error

    @property
    def variance_stands_out(self) -> bool:
        """Whether the variance does that this is the root of: its value over its error
        is half as large."""
        return self.value > 2 * SIGNIFICANT * self.standard_error


def clipped_moments(values: Array) -> tuple[float, float]:
    """Return mean and standard deviation of what lies within 4 sigma.

    values : any shape, finite. Median and MAD are a start alone."""
    flat = values.ravel().astype(np.float64, copy=False)
    some = flat[:: max(1, flat.size // ENOUGH)]
    middle, before = some.size // 2, (0, 0.0)
    mean = float(np.partition(some, middle)[middle])
    sigma = MAD * float(np.partition(np.abs(some - mean), middle)[middle])
    for _ in range(ROUNDS):
        kept = flat[np.abs(flat - mean) <= CUT * sigma]
        mean = float(kept.sum()) / kept.size
        kept -= mean
        sigma = max(math.sqrt(float(kept @ kept) / kept.size / LEFT), 1e-12)
        if before == (before := (kept.size, mean)):
            break
    return mean, sigma


@dataclass(frozen=True)
class LinearFit:
    """values : of the design's columns, (k,), and their covariance. rest : what is left
    of all. variance : of the rest without what lies 4 sigma off."""

    values: Array
    covariance: Array
    rest: Array
    variance: float

    @property
    def clipped(self) -> Array:
        """The rest, cut at 4 sigma."""
        most = CUT * clipped_moments(self.rest)[1]
        return np.clip(self.rest, -most, most)


def linear_fit(design: Array, y: Array, first: int = 0) -> LinearFit:
    """Return least squares of (N,) y by a design, (N, k), without what lies 4 sigma
    off. first : how many of y count however far off they are."""
    keep = np.ones(len(y), bool)
    for _ in range(ROUNDS):
        used, before = design[keep], keep
        values = np.linalg.lstsq(used, y[keep], rcond=None)[0]
        rest = y - design @ values
        freedom = max(int(keep.sum()) - design.shape[1], 1)
        variance = float((rest[keep] ** 2).sum()) / freedom
        keep = np.abs(rest) <= CUT * clipped_moments(rest)[1]
        keep[:first] = True
        if np.array_equal(keep, before):
            break
    return LinearFit(values, np.linalg.pinv(used.T @ used) * variance, rest, variance)

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Measured: a number with its standard error and unit; arithmetic that keeps both."""

import math
from dataclasses import dataclass

SIGNIFICANT = 3.0  # standard errors
# Of the noise variance that an estimator takes off: it is not known better than that,
# by the cut at 4 sigma and by pixels that are not alike.
FLOOR = 0.01


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
        return Measured(
            self.value * factor, abs(self.standard_error * factor), unit or self.unit
        )

    @property
    def squared(self) -> "Measured":
        """Return the variance that a standard deviation is the root of."""
        error = 2 * self.value * self.standard_error
        return Measured(self.value**2, error, f"{self.unit}^2")

    @property
    def stands_out(self) -> bool:
        """Whether the value is more than three standard errors off 0."""
        return abs(self.value) > SIGNIFICANT * self.standard_error

    @property
    def variance_stands_out(self) -> bool:
        """Whether the variance does that this is the root of: its value over its error
        is half as large."""
        return self.value > 2 * SIGNIFICANT * self.standard_error


def root_of(variance: float, standard_error: float, unit: str) -> Measured:
    """Return the standard deviation of a variance that may have come out negative.

    standard_error : of the variance. At 0 the error is the root of half of it."""
    value = math.sqrt(max(variance, 0.0))
    least = math.sqrt(standard_error / 2)
    half = 2 * max(value, least)
    return Measured(value, standard_error / half if half else 0.0, unit)


def ratio(a: Measured, b: Measured, unit: str) -> Measured:
    """Return a / b with the error of both. b is not 0."""
    value = a.value / b.value
    parts = (a.standard_error / b.value, value * b.standard_error / b.value)
    return Measured(value, math.hypot(*parts), unit)

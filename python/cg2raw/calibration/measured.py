# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Measured: a number with its standard error and unit."""

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
    def stands_out(self) -> bool:
        """Whether the value is more than three standard errors off 0."""
        return abs(self.value) > SIGNIFICANT * self.standard_error

    @property
    def variance_stands_out(self) -> bool:
        """Whether the variance does that this is the root of: its value over its error
        is half as large."""
        return self.value > 2 * SIGNIFICANT * self.standard_error

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Design: derivatives of what a model says of a frame, as Fisher scoring needs them."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cg2raw.diagnose.frames.tiling import Array

Rows = NDArray[np.float32]
Derivatives = tuple[Array | None, Array | None]  # of mean and variance; None: all are 0


def scaled(derivatives: Derivatives, by: Array | float) -> Derivatives:
    """Return derivatives times a factor."""
    mean, variance = (None if one is None else one * by for one in derivatives)
    return mean, variance


@dataclass(frozen=True)
class Design:
    """Derivatives by n parameters of the mean and of the variance of the N pixels that
    count, both in standard deviations: of parameters that move these.

    mean, variance : (m, N), (v, N). of_mean, of_variance : (m,), (v,) numbers of the
    parameters, of count in all."""

    count: int
    of_mean: NDArray[np.intp]
    mean: Rows
    of_variance: NDArray[np.intp]
    variance: Rows

    @classmethod
    def of(cls, derivatives: Sequence[Derivatives], pixels: int) -> "Design":
        """derivatives : by each parameter, (N,) of N pixels."""
        mean, variance = (
            _stacked([one[part] for one in derivatives], pixels) for part in (0, 1)
        )
        return cls(len(derivatives), *mean, *variance)

    def scores(self, residual: Rows, square: Rows) -> Array:
        """Return (n,) sums of derivatives times scores (N,) of mean and variance."""
        found = np.zeros(self.count)
        found[self.of_mean] += self.mean @ residual
        found[self.of_variance] += self.variance @ square
        return found

    def after(self, residual: Rows, square: Rows, step: Array) -> tuple[Rows, Rows]:
        """Return scores (N,) of mean and variance after a step (n,) of parameters."""
        moved = step.astype(np.float32)
        residual = residual - moved[self.of_mean] @ self.mean
        return residual, square - moved[self.of_variance] @ self.variance

    def sums_by_label(
        self, labels: NDArray[np.intp], count: int, residual: Rows, square: Rows
    ) -> Array:
        """Return (n, count) of the sums of `scores`, over the pixels of each label
        (N,)."""
        found = np.zeros((self.count, count))
        parts = (
            (self.of_mean, self.mean, residual),
            (self.of_variance, self.variance, square),
        )
        for numbers, rows, scores in parts:
            for k, row in zip(numbers, rows, strict=True):
                found[k] += np.bincount(labels, row * scores, count)
        return found

    def products(self, other: "Design") -> Array:
        """Return (n, k) sums of products with another design of the same pixels."""
        found = np.zeros((self.count, other.count))
        found[np.ix_(self.of_mean, other.of_mean)] += self.mean @ other.mean.T
        of_variances = np.ix_(self.of_variance, other.of_variance)
        found[of_variances] += self.variance @ other.variance.T
        return found

    @cached_property
    def information(self) -> Array:
        """(n, n) Fisher information."""
        return self.products(self)


def _stacked(
    rows: Sequence[Array | None], pixels: int
) -> tuple[NDArray[np.intp], Rows]:
    """Return (numbers of rows that are not None, these)."""
    moved = [k for k, row in enumerate(rows) if row is not None]
    stacked = np.zeros((len(moved), pixels), np.float32)
    for place, k in enumerate(moved):
        stacked[place] = rows[k]
    return np.array(moved, np.intp), stacked

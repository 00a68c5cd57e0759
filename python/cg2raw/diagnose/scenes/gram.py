# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Gram: all that pixels say of a linear model, in one small matrix.

The rows of A are the derivatives of a predicted sample by each parameter, and last the
residual, all in standard deviations. A A^T holds the likelihood of any of these
parameters; nuisances leave it by a Schur complement, and those of scenes add up.
Source: S. Boyd, L. Vandenberghe, Convex Optimization, 2004, appendix A.5.5.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]  # of float64
LEAST_SHARED = 1e-4  # of a score's variance; less is none
RIDGE = 1e-10  # of the information on a parameter: two columns alike stay finite


@dataclass(frozen=True)
class Space:
    """The parameters of some effects, one after the other.

    slices : by the name of an effect, in the order of the registry."""

    slices: Mapping[str, slice]

    @classmethod
    def of(cls, counts: Mapping[str, int]) -> "Space":
        ends = np.cumsum([0, *counts.values()]).tolist()
        return cls({n: slice(*ends[k : k + 2]) for k, n in enumerate(counts)})

    @property
    def size(self) -> int:
        return max((one.stop for one in self.slices.values()), default=0)

    def index(self, names: Iterable[str]) -> NDArray[np.intp]:
        """Return the places of the parameters of some effects, in order."""
        chosen = set(names)
        every = [
            np.arange(s.start, s.stop) for n, s in self.slices.items() if n in chosen
        ]
        return np.concatenate([np.zeros(0, np.intp), *every])


@dataclass(frozen=True)
class Gram:
    """The log-likelihood of n samples, -(squares - 2 score theta + theta information
    theta) / 2, at parameters (P,) counted from the profile's values.

    information : (P, P). score : (P,). shared : (P, P), how much of the score's
    covariance is of fixed patterns, which all frames have in common; by view and
    summed, of so many views."""

    n: float
    squares: float
    score: Array
    information: Array
    shared: Array | float = 0.0
    views: int = 1

    def __add__(self, other: "Gram") -> "Gram":
        return Gram(
            self.n + other.n,
            self.squares + other.squares,
            self.score + other.score,
            self.information + other.information,
            self.shared + other.shared,
            self.views + other.views,
        )

    def gain(self, theta: Array) -> float:
        """Return the log-likelihood over that of the profile, nats."""
        return float(theta @ self.score - 0.5 * theta @ self.information @ theta)

    def with_prior(self, index: NDArray[np.intp], deviations: Array) -> "Gram":
        """Return that of parameters of which some are known to be 0 up to a deviation
        each."""
        information = self.information.copy()
        information[index, index] += deviations**-2.0
        return replace(self, information=information)

    def with_patterns(self, space: Space, name: str) -> "Gram | None":
        """Return that of parameters of which those of an effect are known to be no
        larger than what fixed patterns make of them in all frames alike; None where
        there are no patterns."""
        if not np.any(self.shared):
            return None
        information = self.information.copy()
        at = np.ix_(index := space.index([name]), index)
        own = self.information[at]
        # Views that are alike have the same of it: their scores add, not variances.
        score = self.views * np.asarray(self.shared)[at] + LEAST_SHARED * own
        information[at] += own @ _solved(score, own)
        return replace(self, information=information)

    def fit(self, index: NDArray[np.intp]) -> Array:
        """Return (P,) of most likelihood, 0 but for the parameters of an index."""
        theta = np.zeros_like(self.score)
        part = self.information[np.ix_(index, index)]
        theta[index] = _solved(part, self.score[index])
        return theta

    def covariance(self, index: NDArray[np.intp]) -> Array:
        """Return that of the parameters of an index, (k, k)."""
        part = self.information[np.ix_(index, index)]
        return _solved(part, np.eye(len(index)))

    def given(self, index: NDArray[np.intp], others: NDArray[np.intp]) -> Array:
        """Return the information (k, k) on some parameters when others are fitted."""
        own = self.information[np.ix_(index, index)]
        if not len(others):
            return own
        cross = self.information[np.ix_(others, index)]
        rest = self.information[np.ix_(others, others)]
        return np.asarray(own - cross.T @ _solved(rest, cross))


def _solved(matrix: Array, right: Array) -> Array:
    """Return the solution of normal equations. Of unit diagonal, the ridge means the
    same for all; what no sample shows stays 0."""
    if not len(matrix):
        return np.zeros_like(right)
    diagonal = np.diagonal(matrix)
    shown = diagonal > 0
    d = np.where(shown, 1 / np.sqrt(np.where(shown, diagonal, 1)), 0)
    unit = d[:, None] * matrix * d + np.diag(np.where(shown, RIDGE, 1.0))
    scale = d if right.ndim == 1 else d[:, None]
    return np.asarray(scale * np.linalg.solve(unit, scale * right))


@dataclass(frozen=True)
class Normal:
    """Normal equations A A^T of n samples, whose last row is the residual.

    The first rows are of effects, then of nuisances. shared : as products, what fixed
    patterns have of their noise, summed over views."""

    n: float
    products: Array
    shared: Array | float = 0.0
    views: int = 1

    def __add__(self, other: "Normal") -> "Normal":
        return Normal(
            self.n + other.n,
            self.products + other.products,
            self.shared + other.shared,
            self.views + other.views,
        )

    def without(self, nuisances: NDArray[np.intp], deviations: Array) -> "Normal":
        """Return the same where some rows are known to be 0 up to a deviation each, and
        are integrated out; their rows stay, as zeros."""
        left = self.products.copy()
        inner = left[np.ix_(nuisances, nuisances)] + np.diag(deviations**-2.0)
        taken = np.linalg.solve(inner, left[nuisances])
        left -= left[nuisances].T @ taken
        shared = np.broadcast_to(self.shared, left.shape).copy()
        cross = taken.T @ shared[nuisances]
        shared += taken.T @ shared[np.ix_(nuisances, nuisances)] @ taken
        shared -= cross + cross.T
        shared[nuisances] = shared[:, nuisances] = 0.0
        left[nuisances] = left[:, nuisances] = 0.0
        return replace(self, products=left, shared=shared)

    def found(
        self, nuisances: NDArray[np.intp], deviations: Array, theta: Array
    ) -> Array:
        """Return the nuisances of most likelihood beside parameters theta (P,)."""
        inner = self.products[np.ix_(nuisances, nuisances)] + np.diag(deviations**-2.0)
        right = self.products[nuisances, -1]
        right = right - self.products[nuisances, : len(theta)] @ theta
        return np.asarray(np.linalg.solve(inner, right))

    def gram(self, size: int) -> Gram:
        """Return that of the first parameters, after all else was integrated out."""
        p = self.products
        own, shared = (
            one[:size, :size] for one in (p, np.broadcast_to(self.shared, p.shape))
        )
        return Gram(self.n, float(p[-1, -1]), p[:size, -1], own, shared, self.views)

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What the parts of the likelihood have in common: parameters, and sums of terms."""

from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cg2raw.model.components import FIXED, TEMPORAL
from cg2raw.statistics.constant import Array

LEAST_RATIO = 1e-12  # of what was measured and is expected: nothing was measured


@dataclass(frozen=True)
class Parameters:
    """What the likelihood is a function of: where each is in the vector.

    sites : planes with a black level, read noise and gain of their own."""

    sites: int

    @cached_property
    def names(self) -> tuple[str, ...]:
        """One for each entry; of planes' own, one after the other."""
        of_sites = [
            name
            for name in ("black_level", "read_noise", "gain")
            for _ in range(self.sites)
        ]
        shared = ["dark_current", "black_level_drift"]
        components = [c.name for c in (*TEMPORAL, *FIXED)]
        return (*of_sites, *shared, *components)

    def __len__(self) -> int:
        return len(self.names)

    @cached_property
    def are_variances(self) -> NDArray[np.bool_]:
        """(n,) of lines, patterns and the drift: without any, none is there."""
        sites = 3 * self.sites + 1
        return np.arange(len(self)) >= sites

    @cached_property
    def are_bounded(self) -> NDArray[np.bool_]:
        """(n,) of a drift, and of what single parts have for themselves: few
        coefficients, so that values below 0 would be far below."""
        few = [name == "black_level_drift" or ", " in name for name in self.names]
        return np.array(few)

    def are(self, names: Collection[str]) -> NDArray[np.bool_]:
        """Return (n,) which are of names; of those that each part has, the beginning is
        their name."""
        return np.isin([name.partition(",")[0] for name in self.names], [*names])

    def of(self, name: str, site: int = 0) -> int:
        """Return the place of a parameter. site : of a plane's own."""
        return self.names.index(name) + site

    def each(self, name: str) -> slice:
        """Return the places of a parameter that each plane has, in their order."""
        first = self.of(name)
        return slice(first, first + self.sites)


class Evaluation:
    """A value, its slope and Fisher's information, summed up."""

    def __init__(self, count: int) -> None:
        self.value = 0.0
        self.score: Array = np.zeros(count)
        self.information: Array = np.zeros((count, count))

    def add_chi_square(
        self, measured: Array, expected: Array, slopes: Array, freedom: Array
    ) -> None:
        """Add variances (N,) of given freedom, whose expectation has slopes (N, n). The
        value is 0 where they are expected as measured, whatever their freedom."""
        relative, ratio = slopes / expected[:, None], measured / expected
        nats = freedom / 2 * (ratio - 1 - np.log(np.maximum(ratio, LEAST_RATIO)))
        self.value -= float(nats.sum())
        self.score += freedom / 2 * (ratio - 1) @ relative
        self.information += (relative * (freedom / 2)[:, None]).T @ relative

    def add_normal(
        self,
        rest: Array,
        slopes: Array,
        variance: Array,
        variance_slopes: Array,
        share: float,
    ) -> None:
        """Add residuals (N,) and their variances. share : of their freedom that the
        parameters of their mean leave."""
        relative = variance_slopes / variance[:, None]
        squares = rest**2 / variance
        self.value -= float((share * np.log(variance) + squares).sum()) / 2
        self.score += (squares - share) / 2 @ relative - rest / variance @ slopes
        self.information += (slopes / variance[:, None]).T @ slopes
        self.information += share / 2 * relative.T @ relative

    def add_correlated(self, rest: Array, slopes: Array, covariance: Array) -> None:
        """Add residuals (N,) of a covariance (N, N) that no parameter moves."""
        inverse = np.linalg.inv(covariance)
        self.value -= float(rest @ inverse @ rest) / 2
        self.score -= rest @ inverse @ slopes
        self.information += slopes.T @ inverse @ slopes

    def add_wishart(
        self,
        products: Array,
        freedom: float,
        covariance: Array,
        terms: Array,
        places: NDArray[np.int64],
        diagonal: Array,
    ) -> bool:
        """Add mean products (N, N) of given freedom; return whether their covariance is
        positive, else the value is -inf.

        covariance : (N, N), of which terms, (K, N, N), are the slopes by the parameters
        at places, and diagonal, (N, n), those by all that are on the diagonal alone."""
        try:
            root = np.linalg.cholesky(covariance)
        except np.linalg.LinAlgError:
            self.value = -np.inf
            return False
        half = freedom / 2
        inverse = np.linalg.inv(covariance)
        measured = inverse @ products
        logarithm = 2 * float(np.log(np.diagonal(root)).sum())
        self.value -= half * (logarithm + float(np.trace(measured)))
        misfit: Array = half * (measured @ inverse - inverse)
        self.score += np.diagonal(misfit) @ diagonal
        self.score[places] += terms.reshape(len(terms), -1) @ misfit.ravel()
        turned = inverse @ terms
        mixed = (turned * inverse).sum(axis=2) @ diagonal
        self.information[places] += half * mixed
        self.information[:, places] += half * mixed.T
        self.information += half * diagonal.T @ inverse**2 @ diagonal
        flat = turned.reshape(len(terms), -1)
        other = turned.swapaxes(1, 2).reshape(len(terms), -1)
        self.information[np.ix_(places, places)] += half * flat @ other.T
        return True

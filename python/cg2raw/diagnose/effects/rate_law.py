# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""RateLaw: how fast charge gathers in pixels of which no frame tells anything."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cg2raw import _core
from cg2raw.diagnose.frames.tiling import Array

NEARER = 0.5  # of the noise; parts of a law that are nearer to each other are one
ENDS = (0.02, 0.1, 0.25, 0.5, 0.8, 1.2, 1.8, 2.6, 3.7, 5.2, 7.5, 11.0)  # of a mean


@dataclass(frozen=True)
class RateLaw:
    """A law as a sum of narrow normals: (k,) weights, which add up to 1, means and
    variances of rates, 1/s. A part without a variance is of pixels that do not differ.

    Source: M. Stephens, Biostatistics 18(2), 2017."""

    weights: Array
    means: Array
    variances: Array

    @staticmethod
    def of_few(share: float, mean: float) -> "RateLaw":
        """A share of the pixels has rates of an exponential law of a mean, others have
        none."""
        ends = np.array([0.0, *ENDS])
        beyond = np.exp(-ends)
        weights, first, second = (
            -np.diff(beyond * moment, append=0.0)
            for moment in (1.0, ends + 1, ends**2 + 2 * ends + 2)
        )
        means = first / weights
        variances = second / weights - means**2
        return RateLaw(
            np.append(1 - share, share * weights),
            np.append(0.0, mean * means),
            np.append(0.0, mean**2 * variances),
        )

    @property
    def mean_of_few(self) -> float:
        """Return the mean of those that have any, of a law of few."""
        return float(self.weights[1:] @ self.means[1:] / self.weights[1:].sum())

    @staticmethod
    def together(laws: Sequence["RateLaw"]) -> "RateLaw":
        """Return the law of the sum of rates; where few pixels have any of one, that of
        others counts by its mean and variance."""
        found = laws[0]
        for law in laws[1:]:
            found = found._with_few(law)
        return found

    def _with_few(self, few: "RateLaw") -> "RateLaw":
        mean = float(self.weights @ self.means)
        square = float(self.weights @ (self.variances + self.means**2))
        rest = few.variances == 0
        return RateLaw(
            np.append(few.weights[rest].sum() * self.weights, few.weights[~rest]),
            np.append(self.means, mean + few.means[~rest]),
            np.append(self.variances, square - mean**2 + few.variances[~rest]),
        )

    def coarser(self, width: float) -> "RateLaw":
        """Return the law of fewer normals, those as one that lie within a width."""
        order = np.argsort(self.means, kind="stable")
        weights, means, variances = (
            part[order] for part in (self.weights, self.means, self.variances)
        )
        part = np.floor(means / width)
        starts = np.flatnonzero(np.append(True, np.diff(part) > 0))
        total = np.add.reduceat(weights, starts)
        middle = np.add.reduceat(weights * means, starts) / total
        square = np.add.reduceat(weights * (variances + means**2), starts) / total
        return RateLaw(total, middle, np.maximum(square - middle**2, 0))

    def scores(
        self, z: Array, variance: Array, seconds: float, gain: Array | float
    ) -> tuple[Array, Array]:
        """Return (normal scores of standardised residuals (n,) of pixels whose rates
        are of the law, log of the determinant per pixel).

        variance : (n,), of noise without what rates add. gain : (n,) or one, of
        charge."""
        width = NEARER * float(np.sqrt(np.median(variance))) / seconds
        law = self.coarser(width)
        parts = np.array([law.weights, law.means, law.variances])
        gains = np.broadcast_to(gain, z.shape)
        return _core.normal_scores_of_rates(parts, z, variance, gains, seconds)

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Log-normal law: of rates of pixels, as a sum of narrow normals.

Of such a sum the density of estimates with normal errors, and the posterior of each
value, are closed. Source: M. Stephens, Biostatistics 18(2), 2017.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from cg2raw import _core
from cg2raw.diagnose.effects.base import Values
from cg2raw.diagnose.effects.rate_law import RateLaw
from cg2raw.diagnose.frames.tiling import Array

STEP = 0.125  # of n, between the narrow normals and of each
LARGEST_N = 5.5  # n beyond which no pixel is


@dataclass(frozen=True)
class LogNormal:
    """The law of rate (e^(log_sigma n) - 1), beside a common shift of all estimates."""

    shift: float
    rate: float
    log_sigma: float

    @property
    def sigma(self) -> float:
        """Half of the range that the middle 68.3 % of the pixels have."""
        return float(self.rate * np.sinh(self.log_sigma))

    def normals(self) -> tuple[Values, Values, Values]:
        """Return (weights, means, variances) of the sum of normals, without the
        shift; each has the moments of its part of the law."""
        n = np.arange(-LARGEST_N, LARGEST_N + STEP / 2, STEP)
        weights = np.exp(-0.5 * n**2 / (1 - STEP**2))
        part = (self.log_sigma * STEP) ** 2
        size = self.rate * np.exp(self.log_sigma * n + part / 2)
        return weights / weights.sum(), size - self.rate, size**2 * np.expm1(part)

    @property
    def rate_law(self) -> RateLaw:
        """The same, of pixels of which nothing is known."""
        return RateLaw(*self.normals())

    def log_density(self, rates: "Rates") -> Array:
        """Return that of estimates."""
        density = _core.log_density_of_mixture(*self._beside(rates))
        return density.reshape(rates.estimate.shape)

    def posterior(self, rates: "Rates") -> tuple[Array, Array]:
        """Return (mean, variance) of each pixel's value, given its estimate."""
        mean, variance = _core.posterior_of_mixture(*self._beside(rates))
        shape = rates.estimate.shape
        return mean.reshape(shape), variance.reshape(shape)

    def _beside(self, rates: "Rates") -> tuple[Array, Array]:
        shape = rates.estimate.shape
        columns = [np.broadcast_to(column, shape).ravel() for column in rates.columns]
        columns[0] = columns[0] - self.shift
        return np.stack(self.normals()), np.stack(columns)


@dataclass(frozen=True)
class Rates:
    """Estimates of pixels, with their variance where the rate is 0, what a rate adds to
    it by the shot noise of its charge, and how much of it a pixel has by its charge at
    rate 0: what a rate below takes at most, as there is no noise of less charge."""

    estimate: Array
    error: Array
    per_rate: Array
    of_charge: Array

    def error_at(self, rate: Array | float) -> Array:
        """Return the variance of estimates of a rate."""
        return self.error + np.maximum(self.per_rate * rate, -self.of_charge)

    @property
    def columns(self) -> tuple[Array, Array, Array, Array]:
        return self.estimate, self.error, self.per_rate, self.of_charge

    def at(self, places: Any) -> "Rates":
        return Rates(*(column[places] for column in self.columns))

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Log-normal law: of rates of pixels, as a sum of narrow normals.

Of such a sum the density of estimates with normal errors, and the posterior of each
value, are closed. Source: M. Stephens, Biostatistics 18(2), 2017.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from cg2raw.diagnose.effects.base import Values
from cg2raw.diagnose.effects.rate_law import RateLaw
from cg2raw.diagnose.frames.tiling import Array

STEP = 0.125  # of n, between the narrow normals and of each
LARGEST_N = 5.5  # n beyond which no pixel is
PIECE = 2048  # estimates, of which all parts are looked at together
LEAST_ERROR = 0.05  # of a variance, that is left where a rate is below the median


def log_sum(logs: Array) -> Array:
    """Return the log of sums over the first axis, of finite logs."""
    top = logs.max(0)
    return np.asarray(top + np.log(np.exp(logs - top).sum(0)))


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
        """Return (log weights, means, variances) of the sum of normals, without the
        shift; each has the moments of its part of the law."""
        n = np.arange(-LARGEST_N, LARGEST_N + STEP / 2, STEP)
        weights = -0.5 * n**2 / (1 - STEP**2)
        part = (self.log_sigma * STEP) ** 2
        size = self.rate * np.exp(self.log_sigma * n + part / 2)
        return weights - log_sum(weights), size - self.rate, size**2 * np.expm1(part)

    @property
    def rate_law(self) -> RateLaw:
        """The same, of pixels of which nothing is known."""
        weights, means, variances = self.normals()
        return RateLaw(np.exp(weights), means, variances)

    def log_parts(self, rates: "Rates") -> Array:
        """Return (k, ...) log density of estimates by each normal."""
        weights, means, variances = (
            part.reshape(-1, *[1] * rates.estimate.ndim) for part in self.normals()
        )
        total = variances + rates.error_at(means)
        away = rates.estimate - self.shift - means
        return np.asarray(weights - 0.5 * (away**2 / total + np.log(2 * np.pi * total)))

    def log_density(self, rates: "Rates") -> Array:
        """Return that of estimates."""
        return rates.by_pieces(lambda piece: (log_sum(self.log_parts(piece)),))[0]

    def posterior(self, rates: "Rates") -> tuple[Array, Array]:
        """Return (mean, variance) of each pixel's value, given its estimate."""
        mean, variance = rates.by_pieces(self._posterior)
        return mean, variance

    def _posterior(self, rates: "Rates") -> tuple[Array, Array]:
        mean, square = np.zeros((2, *rates.estimate.shape))
        logs = self.log_parts(rates)
        share = np.exp(logs - log_sum(logs))
        for part, middle, variance in zip(share, *self.normals()[1:], strict=True):
            error = rates.error_at(middle)
            kept = variance / (variance + error)
            value = middle + kept * (rates.estimate - self.shift - middle)
            mean += part * value
            square += part * (value**2 + kept * error)
        return mean, np.maximum(square - mean**2, 0)


@dataclass(frozen=True)
class Rates:
    """Estimates of pixels, with their variance where the rate is 0, and what a rate
    adds to it by the shot noise of its charge."""

    estimate: Array
    error: Array
    per_rate: Array

    def error_at(self, rate: Array | float) -> Array:
        """Return the variance of estimates of a rate."""
        least = LEAST_ERROR * self.error
        return np.asarray(np.maximum(self.error + self.per_rate * rate, least))

    @property
    def columns(self) -> tuple[Array, Array, Array]:
        return self.estimate, self.error, self.per_rate

    def by_pieces(
        self, of: Callable[["Rates"], tuple[Array, ...]]
    ) -> tuple[Array, ...]:
        """Return what a function of estimates says of each, in as few at a time as a
        processor's cache holds with all parts of a law."""
        shape, size = self.estimate.shape, self.estimate.size
        flat = Rates(*(np.broadcast_to(one, shape).ravel() for one in self.columns))
        starts = range(0, max(size, 1), PIECE)
        pieces = [of(flat.at(slice(start, start + PIECE))) for start in starts]
        joined = (np.concatenate(parts) for parts in zip(*pieces, strict=True))
        return tuple(one.reshape(shape) for one in joined)

    def at(self, places: Any) -> "Rates":
        return Rates(*(column[places] for column in self.columns))

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Noise that neighbours share: by the read-out along rows, and by noise reduction.

Read noise is autoregressive of order 1 along a row of the mosaic. Noise reduction
blends all noise with that of the four of its colour beside, and of the four across."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from cg2raw.model.correlation import neighbours
from cg2raw.model.fit import Fit, Prior
from cg2raw.statistics.codes import ROUNDING
from cg2raw.statistics.constant import LAGS, PIXEL, Array, ConstantStatistics

NAMES = {"read_noise_correlation": [0], "noise_reduction": [1, 2]}
LEAST_RELATIVE = 1e-4  # far below what variances are known to
LOWEST, HIGHEST = (-0.5, 0.0, 0.0), (0.5, 0.9, 0.4)  # as of docs/effects.md


@dataclass(frozen=True)
class Lags:
    """Correlations of the noise of repeats with that of neighbours.

    measured : (G, lags). samples : (G,) whose products each is the mean of. side : px
    of the CFA's repeat. read, whole : (G,) shares of the recorded variance: of read
    noise, and of all noise but for rounding. ratios, errors : (R,) logarithms of read
    noise and gain over the profile's, which noise reduction would lower alike, and
    their standard errors."""

    measured: Array
    samples: Array
    side: int
    read: Array
    whole: Array
    ratios: Array
    errors: Array

    def expected(self, values: Array) -> Array:
        """Return (G, lags) for (coefficient, blend, diagonal)."""
        coefficient, *blended = values
        shared = shared_by(*blended)
        found = np.zeros_like(self.measured)
        for n, (down, across) in enumerate(LAGS):
            if down == 0:
                found[:, n] += self.read * coefficient**across
            if down % self.side == 0 and across % self.side == 0:
                steps = down // self.side, across // self.side
                found[:, n] += self.whole * shared[steps]
        return found

    def value(self, values: Array) -> float:
        """Return the log-likelihood, nats, but for a constant."""
        return -float((self._rest(values) ** 2).sum()) / 2

    def _rest(self, values: Array) -> Array:
        rest = (self.measured - self.expected(values)) * np.sqrt(self.samples)[:, None]
        return rest.ravel()

    def of_ratios(self, expected: Array | float) -> float:
        """Return the log-likelihood of the ratios, nats, but for a constant."""
        return -float((((self.ratios - expected) / self.errors) ** 2).sum()) / 2

    def fitted(self, pinned: Array, *, by_ratios: bool = False) -> tuple[Array, Array]:
        """Return the likeliest values and their covariance, (3, 3). pinned : (3,), nan
        of those that are fitted. by_ratios : noise reduction has made the ratios."""
        free = np.isnan(pinned)
        low, high = np.array(LOWEST), np.array(HIGHEST)

        def whole(some: Array) -> Array:
            found = pinned.copy()
            found[free] = some
            return found

        def rest(some: Array) -> Array:
            values = whole(some)
            left = np.log(variance_left(*values[1:]))
            more = (self.ratios - left) / self.errors * by_ratios
            return np.concatenate([self._rest(values), more])

        if not free.any():
            return pinned, np.zeros((3, 3))
        start = np.array([0.0, 0.01, 0.01])[free]
        found = least_squares(rest, start, bounds=(low[free], high[free]))
        covariance = np.zeros((3, 3))
        covariance[np.ix_(free, free)] = np.linalg.pinv(found.jac.T @ found.jac)
        return whole(found.x), covariance


def shared_by(blend: float, diagonal: float) -> dict[tuple[int, int], float]:
    """Return correlations of white noise that was blended, by (rows, columns) in steps
    of one colour."""
    own = 1 - blend - diagonal
    left = variance_left(blend, diagonal)
    beside = own * blend / 2 + blend * diagonal / 4
    found = {
        (0, 1): beside,
        (0, 2): blend**2 / 16 + diagonal**2 / 8,
        (1, 1): own * diagonal / 2 + blend**2 / 8,
        (2, 2): diagonal**2 / 16,
    }
    found |= {(1, 0): found[0, 1], (2, 0): found[0, 2]}
    return {steps: value / left for steps, value in found.items()}


def variance_left(blend: float, diagonal: float) -> float:
    """Return the share of the variance of white noise that blending leaves."""
    return (1 - blend - diagonal) ** 2 + (blend**2 + diagonal**2) / 4


@dataclass(frozen=True)
class Blended:
    """What noise reduction leaves of variances, and its standard error."""

    left: float
    error: float

    @classmethod
    def of(cls, values: Array, covariance: Array) -> "Blended":
        """values, covariance : as Lags.fitted returns them."""
        left = variance_left(*values[1:])
        step = 1e-4
        slope = np.array(
            [
                (variance_left(*(values[1:] + step * one)) - left) / step
                for one in np.eye(2)
            ]
        )
        return cls(left, float(np.sqrt(slope @ covariance[1:, 1:] @ slope)))

    def prior(self, places: NDArray[np.int64], profile: Array) -> Prior:
        """Return where it takes a profile's variances, all in common."""
        means = profile[places]
        covariance = self.error**2 * np.outer(means, means)
        alone = np.diag((LEAST_RELATIVE * means) ** 2)
        return Prior(places, self.left * means, covariance + alone)


def lags_of(statistics: ConstantStatistics, found: Fit, profile: Array) -> Lags | None:
    """Return the correlations of groups with pairs; None if there are none.

    profile : (n,) parameters of the null."""
    groups = np.flatnonzero(statistics.pairs)
    if not len(groups):
        return None
    planes = found.likelihood.planes
    recorded = np.mean([plane.scatter[groups, PIXEL] for plane in planes], axis=0)
    at, sites = found.parameters.of, range(found.parameters.sites)
    read = np.mean([found.theta[at("read_noise", s)] for s in sites])
    all_lags = [neighbours(statistics, *lag) for lag in LAGS]
    samples = sum(float((~plane.plane.masked).sum()) for plane in planes)
    pairs = statistics.pairs[groups].astype(float)
    places = np.array([at(name, s) for name in ("read_noise", "gain") for s in sites])
    errors = np.sqrt(np.diagonal(found.covariance))[places] / found.theta[places]
    known = np.isfinite(errors) & (errors > 0) & (profile[places] > 0)
    places, errors = places[known], errors[known]
    return Lags(
        measured=np.array(all_lags).T[groups],
        samples=pairs * samples,
        side=planes[0].side,
        read=np.clip(read / recorded, 0.0, 1.0),
        whole=np.clip(1 - ROUNDING / recorded, 0.0, 1.0),
        ratios=np.log(found.theta[places] / profile[places]),
        errors=errors,
    )


def lag_gains(
    training: Lags, validation: Lags
) -> tuple[dict[str, float], Array, Array]:
    """Return the nats of each name on validation frames, its values as trained and the
    other's fitted anew, over the same without it; the trained values; their
    covariance.

    If noise reduction is as likely to have lowered read noise and gain as both by
    themselves, its nats are of them, too."""
    nothing = np.full(3, np.nan)
    trained, covariance = training.fitted(nothing)
    without = {
        name: validation.value(validation.fitted(_with(places, np.zeros(3)))[0])
        for name, places in NAMES.items()
    }
    gains = {
        name: validation.value(validation.fitted(_with(places, trained))[0])
        - without[name]
        for name, places in NAMES.items()
    }
    name = "noise_reduction"
    if len(training.ratios) == len(validation.ratios) > 0:
        both, of_both = training.fitted(nothing, by_ratios=True)
        value = validation.value(validation.fitted(_with(NAMES[name], both))[0])
        value += validation.of_ratios(np.log(variance_left(*both[1:])))
        if value >= without[name] + validation.of_ratios(training.ratios):
            gain = value - without[name] - validation.of_ratios(0.0)
            if gain > gains[name]:
                return gains | {name: gain}, both, of_both
    return gains, trained, covariance


def _with(places: list[int], values: Array) -> Array:
    """Return values at places, nan elsewhere."""
    found = np.full(3, np.nan)
    found[places] = values[places]
    return found

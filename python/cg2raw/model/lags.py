# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Noise that neighbours share: by the read-out along rows, and by noise reduction.

Read noise is autoregressive of order 1 along a row of the mosaic. Noise reduction
blends all noise with that of the four of its colour beside, and of the four across."""

from collections.abc import Collection
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from cg2raw.model.fit import Fit, Prior
from cg2raw.model.smallest_set import SmallestSet, Way, smallest_set
from cg2raw.model.values import LOGARITHMS
from cg2raw.statistics.codes import ROUNDING
from cg2raw.statistics.constant import (
    FIELD,
    LAGS,
    PIXEL,
    Array,
    ConstantStatistics,
)

FILTER = "noise_reduction"
PARAMETERS = (  # of effects, in the order of values here
    ("read_noise_correlation", "coefficient"),
    (FILTER, "blend"),
    (FILTER, "diagonal"),
)
NAMES = {"read_noise_correlation": [0], FILTER: [1, 2]}  # their places
LEAST_RELATIVE = 1e-4  # far below what variances are known to
NOTHING: Array = np.zeros(3)
ALONG = np.arange(-8, 9)  # px of a row, beyond which read noise has little in common
LOWEST, HIGHEST = (-0.5, 0.0, 0.0), (0.5, 0.9, 0.4)  # as of docs/effects.md


@dataclass(frozen=True)
class Lags:
    """Correlations of the noise of repeats with that of neighbours.

    measured : (G, lags), of residuals. samples : (G,) whose products each is the mean
    of; residuals' variance is by their degrees of freedom. side : px of the CFA's
    repeat. shape : of a plane. read, whole : (G,) shares of the recorded variance: of
    read noise, and of all noise but for rounding. ratios, errors, of : (R,) logarithms
    of read noise and gain over the profile's, which noise reduction would lower alike,
    their standard errors, and names of LOGARITHMS. null : (coefficient, blend,
    diagonal) of the profile."""

    measured: Array
    samples: Array
    side: int
    shape: tuple[int, int]
    read: Array
    whole: Array
    ratios: Array
    errors: Array
    of: NDArray[np.str_]
    null: Array

    def expected(self, values: Array) -> Array:
        """Return (G, lags) for (coefficient, blend, diagonal)."""
        coefficient, *blended = values
        in_blend, in_rows = self._shares
        white = in_blend[:, 2, 2]
        of_blend = (in_blend * shared_by(*blended)).sum(axis=(1, 2)) - white
        of_rows = in_rows @ coefficient ** np.abs(ALONG) - white
        found = white + np.outer(self.whole, of_blend) + np.outer(self.read, of_rows)
        return np.asarray(found[:, 1:] / found[:, :1] * white[0])

    @cached_property
    def _shares(self) -> tuple[Array, Array]:
        """Return (1 + lags, 5, 5), (1 + lags, ALONG): of the covariance of residuals at
        no lag and at each, what has that of noise at up to two steps of one colour, and
        at places along a row."""
        steps = self.side * np.arange(-2, 3)
        every = ((0, 0), *LAGS)
        blend = [left_of(lag, steps, steps, self.side, self.shape) for lag in every]
        rows = [
            left_of(lag, np.zeros(1, int), ALONG, self.side, self.shape)[0]
            for lag in every
        ]
        return np.array(blend), np.array(rows)

    def value(self, values: Array) -> float:
        """Return the log-likelihood, nats, but for a constant."""
        return -float((self._rest(values) ** 2).sum()) / 2

    def _rest(self, values: Array) -> Array:
        rest = (self.measured - self.expected(values)) * np.sqrt(self.samples)[:, None]
        return rest.ravel()

    def lowered(self, values: Array) -> float:
        """Return the logarithm of what noise reduction leaves over a profile's."""
        left = variance_left(*values[1:]) / variance_left(*self.null[1:])
        return float(np.log(left))

    def of_ratios(self, expected: Array | float) -> float:
        """Return the log-likelihood of the ratios, nats, but for a constant."""
        return -float((((self.ratios - expected) / self.errors) ** 2).sum()) / 2

    def fitted_of(self, names: Collection[str]) -> tuple[Array, Array]:
        """Return the likeliest values of some of NAMES and their covariance, as fitted;
        others are as the profile has them."""
        is_free = [name in names for name, _ in PARAMETERS]
        return self.fitted(np.where(is_free, np.nan, self.null))

    @cached_property
    def unreduced(self) -> tuple[Array, Array]:
        """The likeliest values and their covariance with no more noise reduction than
        the profile has."""
        return self.fitted(_with(NAMES[FILTER], self.null))

    def fitted(
        self, pinned: Array, lowered: NDArray[np.bool_] | bool = False
    ) -> tuple[Array, Array]:
        """Return the likeliest values and their covariance, (3, 3). pinned : (3,), nan
        of those that are fitted. lowered : (R,) ratios that noise reduction made."""
        free = np.isnan(pinned)
        low, high = np.array(LOWEST), np.array(HIGHEST)

        def whole(some: Array) -> Array:
            found = pinned.copy()
            found[free] = some
            return found

        def rest(some: Array) -> Array:
            values = whole(some)
            more = (self.ratios - self.lowered(values)) / self.errors * lowered
            return np.concatenate([self._rest(values), more])

        if not free.any():
            return pinned, np.zeros((3, 3))
        start = np.array([0.0, 0.01, 0.01])[free]
        found = least_squares(rest, start, bounds=(low[free], high[free]))
        covariance = np.zeros((3, 3))
        covariance[np.ix_(free, free)] = np.linalg.pinv(found.jac.T @ found.jac)
        return whole(found.x), covariance


def variance_left(blend: float, diagonal: float) -> float:
    """Return the share of the variance of white noise that blending leaves."""
    return (1 - blend - diagonal) ** 2 + (blend**2 + diagonal**2) / 4


def variance_left_of_lines(blend: float, diagonal: float) -> float:
    """Return the share that blending leaves of the variance of rows, or of columns,
    whose samples are alike."""
    return (1 - blend / 2 - diagonal) ** 2 + (blend / 2 + diagonal) ** 2 / 2


def shared_by(blend: float, diagonal: float) -> Array:
    """Return (5, 5) correlations of white noise that was blended, at up to two steps of
    one colour down and across."""
    kernel = np.array([diagonal, blend, diagonal]) / 4
    kernel = np.stack([kernel, [blend / 4, 1 - blend - diagonal, blend / 4], kernel])
    windows = np.lib.stride_tricks.sliding_window_view(np.pad(kernel, 2), (3, 3))
    found = np.einsum("ijkl,kl", windows, kernel)
    return np.asarray(found / found[2, 2])


def left_of(
    lag: tuple[int, int],
    down: NDArray[np.int64],
    across: NDArray[np.int64],
    side: int,
    shape: tuple[int, int],
) -> Array:
    """Return (rows, columns), what the covariance of residuals at a lag has of that of
    noise at distances down and across, px.

    Residuals of a plane have lost the means of their lines and the field, with what
    noise has there in common with all along them."""
    rows, columns = np.meshgrid(down, across, indexing="ij")
    same_row, same_column = rows == lag[0], columns == lag[1]
    h, w = shape
    found = same_row * same_column - same_row / w - same_column / h
    found = found + (1 - FIELD**2) / (h * w)
    in_planes = (rows - lag[0]) % side + (columns - lag[1]) % side == 0
    return np.asarray(np.where(in_planes, found, 0.0))


@dataclass(frozen=True)
class Blended:
    """What noise reduction leaves of variances over what a profile's leaves, and its
    standard error."""

    left: float
    error: float

    @classmethod
    def of(cls, lags: Lags, values: Array, covariance: Array) -> "Blended":
        """values, covariance : as Lags.fitted returns them."""
        left, step = np.exp(lags.lowered(values)), 1e-4
        slope = np.array(
            [
                (np.exp(lags.lowered(values + step * one)) - left) / step
                for one in np.eye(3)[1:]
            ]
        )
        return cls(float(left), float(np.sqrt(slope @ covariance[1:, 1:] @ slope)))

    def prior(self, places: NDArray[np.int64], profile: Array) -> Prior:
        """Return where it takes a profile's variances, all in common."""
        means = profile[places]
        covariance = self.error**2 * np.outer(means, means)
        alone = np.diag((LEAST_RELATIVE * means) ** 2)
        return Prior(places, self.left * means, covariance + alone)


def lags_of(
    statistics: ConstantStatistics,
    found: Fit,
    profile: Array,
    has_tails: bool = False,
    null: Array = NOTHING,
) -> Lags | None:
    """Return the correlations of groups with pairs; None if there are none.

    profile : (n,) parameters of the null; null : (coefficient, blend, diagonal) of it.
    has_tails : read noise has, and what is not masked of it is less for that."""
    groups = np.flatnonzero(statistics.pairs)
    shape = statistics.planes[0].shape
    if not len(groups) or min(shape) <= FIELD:
        return None
    planes = found.likelihood.planes
    recorded = np.mean([plane.scatter[groups, PIXEL] for plane in planes], axis=0)
    read = found.theta[found.parameters.each("read_noise")].mean()
    pairs = statistics.pairs[groups].astype(float)
    lowered = [one for one in LOGARITHMS if not (has_tails and one == "read_noise")]
    every = np.arange(len(profile))
    own = [found.parameters.each(LOGARITHMS[one][0]) for one in lowered]
    places = np.concatenate([every[one] for one in own])
    of = np.repeat(lowered, found.parameters.sites)
    errors = np.sqrt(np.diagonal(found.covariance))[places] / found.theta[places]
    known = np.isfinite(errors) & (errors > 0) & (profile[places] > 0)
    places, errors, of = places[known], errors[known], of[known]
    return Lags(
        measured=statistics.lags[groups],
        samples=pairs * statistics.unmasked,
        side=planes[0].side,
        shape=shape,
        read=np.clip(read / recorded, 0.0, 1.0),
        whole=np.clip(1 - ROUNDING / recorded, 0.0, 1.0),
        ratios=np.log(found.theta[places] / profile[places]),
        errors=errors,
        of=of,
        null=null,
    )


def lag_gains(
    training: Lags, validation: Lags, least: float
) -> tuple[SmallestSet, Array, Array]:
    """Return the nats of each name on validation frames, its values as trained and the
    other's fitted anew, over the same without it; the trained values; their
    covariance.

    Noise reduction lowers read noise and gain alike: it is named if it is in the
    smallest set of these three that explains both; alike are those that may be in the
    place of one of these. least : nats that a name needs."""
    nothing, places = np.full(3, np.nan), NAMES[FILTER]
    alike = np.array_equal(training.of, validation.of)
    every = {FILTER: len(places)}
    every |= {name: 1 for name in LOGARITHMS if alike and name in training.of}

    @cache  # each way asks for what the other has
    def fitted(at: int, names: frozenset[str]) -> tuple[Array, Array, Array]:
        """Return values, their covariance, and the ratios that they expect. at : of the
        split, 0 or 1."""
        lags = (training, validation)[at]
        values, covariance = lags.unreduced
        if FILTER in names:
            own = np.isin(lags.of, list(names))
            values, covariance = lags.fitted(nothing, ~own & alike)
        expected = np.full(len(lags.of), lags.lowered(values))
        for name in names:
            if (own := lags.of == name).any():
                expected[own] = lags.ratios[own].mean()
        return values, covariance, expected

    def way(at: int) -> Way:
        """Return how frames of a split judge values of the other."""
        judge = (training, validation)[at]

        def value(names: Collection[str], found: tuple[Array, Array, Array]) -> float:
            values, _, expected = found
            own = judge.unreduced[0]
            if FILTER in names:
                own = judge.fitted(_with(places, values))[0]
            return judge.value(own) + (judge.of_ratios(expected) if alike else 0.0)

        return Way(
            lambda names: fitted(1 - at, frozenset(names)),
            value,
            lambda names: value(names, fitted(at, frozenset(names))),
        )

    found = smallest_set(every, least, [way(1), way(0)])
    values, covariance, _ = fitted(0, frozenset(found.gains))
    along = NAMES["read_noise_correlation"]
    of_rows = [
        validation.value(validation.fitted(_with(along, one))[0])
        for one in (training.fitted(nothing)[0], validation.null)
    ]
    gains = {
        "read_noise_correlation": of_rows[0] - of_rows[1],
        FILTER: found.gains.get(FILTER, 0.0),
    }
    return SmallestSet(gains, found.alike), values, covariance


def _with(places: list[int], values: Array) -> Array:
    """Return values at places, nan elsewhere."""
    found = np.full(3, np.nan)
    found[places] = values[places]
    return found

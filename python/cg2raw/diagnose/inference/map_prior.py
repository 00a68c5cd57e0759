# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The prior of a map: its variance, from estimates of all pixels and their errors."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.special import expit, ndtr

from cg2raw.diagnose.frames.tiling import Array

HUBER_BOUND = 2.5  # standard deviations that a pixel counts for in the prior
LONGEST_TAIL = 6.0  # standard deviations, from where on a pixel is of the tail
FEWEST_WIDE = 5  # pixels of a tail
MIXING_ROUNDS = 30  # of expectation and maximisation
MOST_MIXED = 65536  # that they go by
NEARLY = 1e-3  # nats per pixel, that a profile's law of a map may lose to the best
LEAST_NARROW = 1e-200


@dataclass(frozen=True)
class Stated:
    """What a profile says of a map's law.

    numbers : by the registry's names. held : the law has these, whatever pixels say.
    hot : what it says of the pixels that are hot beyond a log-normal law."""

    numbers: Mapping[str, float]
    held: bool = False
    hot: "Stated | None" = None

    def holds(self, lost: float, pixels: float) -> bool:
        """Return whether a law has these numbers, of which all pixels together lose so
        many nats to the likeliest."""
        return self.held or lost < NEARLY * pixels


def prior_of(square: Array, error: Array) -> float:
    """Return the variance of a map from squares of estimates and their errors.

    Each square counts at most HUBER_BOUND**2 times its variance: a few pixels that are
    hot, or wrong, are no map. Source: P. J. Huber, Ann. Math. Stat. 35(1), 1964,
    proposal 2."""
    if not square.size:
        return 0.0
    density = np.exp(-0.5 * HUBER_BOUND**2) / np.sqrt(2 * np.pi)
    beyond = ndtr(-HUBER_BOUND)
    expected = 1 - 2 * beyond - 2 * HUBER_BOUND * density + 2 * HUBER_BOUND**2 * beyond

    def excess(prior: float) -> float:
        scaled = square / (error + prior)
        return float(np.minimum(scaled, HUBER_BOUND**2).mean() - expected)

    high = float(square.mean()) + 1e-30
    if excess(0.0) <= 0:
        return 0.0
    while excess(high) > 0:
        high *= 2
    return float(brentq(excess, 0.0, high, rtol=1e-6, xtol=1e-30))


def bounded_tail(square: Array, error: Array) -> float:
    """Return the same with half of what a map's long tails add."""
    prior = prior_of(square, error)
    bounded = np.minimum(square, LONGEST_TAIL**2 * (error + prior))
    weight = 1 / (error + prior + 1e-300)
    mean = ((bounded - error) * weight).sum() / max(weight.sum(), 1e-300)
    return max(prior, 0.5 * float(mean))


def lost_by_variance(stated: float, found: float, error: Array) -> float:
    """Return the nats that estimates, with errors of these variances, lose by a stated
    variance of their map, if the one that was found is the likeliest."""
    ratio = (error + found + LEAST_NARROW) / (error + stated + LEAST_NARROW)
    return float(np.sum(0.5 * (ratio - 1 - np.log(ratio))))


@dataclass(frozen=True)
class MixedPrior:
    """A normal map of which a few pixels are wide: share, variances of both kinds."""

    share: float
    narrow: float
    wide: float

    def half_of_tail(self, error: Array) -> float:
        """Return half of the variance that those that are wide bring, as far as they
        are counted."""
        most = LONGEST_TAIL**2 * (float(np.median(error)) + self.narrow)
        return 0.5 * self.share * min(self.wide, most)

    def posterior(self, estimate: Array, error: Array) -> tuple[Array, Array]:
        """Return (mean, variance) of each pixel's value, given its estimate."""
        wide = self._probability(estimate**2, error)
        mean, square = np.zeros((2, *estimate.shape))
        for share, variance in ((1 - wide, self.narrow), (wide, self.wide)):
            kept = variance / (variance + error)
            mean += share * kept * estimate
            square += share * ((kept * estimate) ** 2 + kept * error)
        return mean, np.maximum(square - mean**2, 0)

    def _probability(self, square: Array, error: Array) -> Array:
        """Return that of each pixel to be wide."""
        odds = np.log(self.share) - np.log1p(-self.share)
        for variance, sign in ((self.wide, 1.0), (self.narrow, -1.0)):
            total = variance + error
            odds = odds - 0.5 * sign * (np.log(total) + square / total)
        probability: Array = expit(odds)
        return probability


def mixed_prior_of(
    square: Array, error: Array, stated: float | None = None
) -> MixedPrior | None:
    """Return the prior of a map with long tails; None if it has none.

    By expectation and maximisation, on some of the pixels if they are many. stated :
        the variance of those that are not wide, if it is known. Source: as of
        sparse_map."""
    step = max(1, square.size // MOST_MIXED)
    square, error = square[::step], error[::step]
    narrow = prior_of(square, error) if stated is None else stated
    far = square > LONGEST_TAIL**2 * (error + narrow)
    if far.sum() < FEWEST_WIDE:
        return None
    wide = float((square - error)[far].mean())
    prior = MixedPrior(float(far.mean()), narrow, wide)
    for _ in range(MIXING_ROUNDS):
        weight = prior._probability(square, error)
        share = float(np.clip(weight.mean(), 1 / square.size, 0.5))
        wide = max(float((weight * (square - error)).sum() / weight.sum()), narrow)
        rest = 1 - weight
        if stated is None:
            narrow = max(float((rest * (square - error)).sum() / rest.sum()), 0.0)
        prior = MixedPrior(share, narrow, max(wide, 2 * narrow, LEAST_NARROW))
    return prior

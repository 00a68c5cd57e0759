# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The prior of a map: its variance, from estimates of all pixels and their errors."""

import numpy as np
from scipy.optimize import brentq
from scipy.special import ndtr

from cg2raw.diagnose.frames.tiling import Array

HUBER_BOUND = 2.5  # standard deviations that a pixel counts for in the prior
LONGEST_TAIL = 6.0


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


def long_tailed_prior_of(square: Array, error: Array) -> float:
    """Return the same for a map with long tails: half of what they add."""
    prior = prior_of(square, error)
    bounded = np.minimum(square, LONGEST_TAIL**2 * (error + prior))
    weight = 1 / (error + prior + 1e-300)
    mean = ((bounded - error) * weight).sum() / max(weight.sum(), 1e-300)
    return max(prior, 0.5 * float(mean))

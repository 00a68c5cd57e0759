# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The law of pixels' dark current: most are log-normal, a few hot ones exponential
besides, and what was measured has normal noise.

Source: R. L. Baer, Proc. SPIE 6068, 2006 (log-normal); R. Widenhorn et al., Proc. SPIE
4669, 2002 (tails)."""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from scipy.special import erfcx, ndtr

from cg2raw.statistics.constant import RATE_EDGES, Array

NODES = np.linspace(-5.5, 5.5, 221)  # of the normal that the log-normal is made of
WEIGHTS = np.exp(-(NODES**2) / 2) / np.exp(-(NODES**2) / 2).sum()
EACH = 10  # of them, where hot pixels are
FAR = 20.0  # times the noise, where hot pixels are looked for first
# A wider law is one of few pixels that are hot, and says nothing of most.
MOST_LOG_SIGMA = 2.0
MOST_HOT = 0.2  # as the registry bounds it
LEAST_HOT = 1e-7  # share of hot pixels that is tried
# A law that ends here is a normal: noise that is wider than it was taken for.
LEAST_LOG_SIGMA = 0.02
HOT = 6.0  # times the deviation of most, that the mean of hot pixels is above them
MIDDLE = (0.159, 0.841)  # of the pixels, a standard deviation to either side
# Of the numbers that are searched for: shift, and logarithms of the others.
LOW = np.array([-1e3, *np.log([1e-3, LEAST_LOG_SIGMA, LEAST_HOT, HOT])])
HIGH = np.array([1e3, *np.log([1e3, MOST_LOG_SIGMA, MOST_HOT, 1e5])])
LEAST_NOISE = 0.1  # squared, of pixels far below the mean
LEAST_SHARE = 1e-12  # of a bin: what no law expects
ROUNDS = 60  # of scoring
DAMPED, FREED = 4.0, 0.25  # how the damping changes by a round
DONE = 1e-4  # nats
LOG_SIGMAS = np.geomspace(0.05, 2.0, 16)  # that a median is averaged over
KNOWN = 0.1  # relative error of log_sigma, by which its likelihood is normal
# Relative, of share and rate as a profile has them: half a kelvin makes a twentieth.
HOT_ERROR = 0.05
NOTHING = np.zeros(5)
FIXED = 1e6  # times as sure: first all else is found
LEAST_NATS = 10.0  # of evidence for a law of two parameters
# Of how far noise moves the median: by so much a log-normal law was seen to miss that
# of inverse Gaussian rates, the other law of R. L. Baer, Proc. SPIE 6068, 2006.
OTHER_LAW = 1 / 7
AROUND = np.linspace(-0.5, 0.5, 101)  # noises about a median, which codes do not move


@dataclass(frozen=True)
class DarkLaw:
    """shift + rate (exp(log_sigma n) - 1), n normal, of all pixels but a fraction, to
    which an exponential of mean @hot_rate adds; all over the noise.

    errors : (5,) of these numbers, 0 of those that were not searched for. nats : their
    log likelihood. shot : by how much the square of the noise, 1 at a rate of 0, grows
    with the rate: charge has a noise of its own."""

    shift: float
    rate: float
    log_sigma: float
    fraction: float
    hot_rate: float
    errors: Array
    nats: float
    shot: float

    def over(self, unit: float, shot: float) -> "DarkLaw":
        """Return the law of rates over another noise, of so many of this one's; its
        errors stay."""
        each = self.shift, self.rate, self.hot_rate
        shift, rate, hot_rate = (one / unit for one in each)
        return replace(self, shift=shift, rate=rate, hot_rate=hot_rate, shot=shot)

    @property
    def values(self) -> Array:
        """(5,) as in the formula."""
        each = self.shift, self.rate, self.log_sigma, self.fraction, self.hot_rate
        return np.array(each)

    @property
    def numbers(self) -> Array:
        """(5,) the shift, and logarithms of the others, as they are searched for."""
        return np.append(self.shift, np.log(np.maximum(self.values[1:], LEAST_HOT)))

    @property
    def shares(self) -> Array:
        """(bins,) expected, between RATE_EDGES."""
        return shares_of(self.values, self.shot)


def nats_of(counts: Array, law: DarkLaw) -> float:
    """Return the log likelihood of counts by RATE_EDGES."""
    return float(counts @ np.log(np.maximum(law.shares, LEAST_SHARE)))


def fitted(counts: Array, shot: float = 0.0, *, uneven: bool, hot: bool) -> DarkLaw:
    """Return the law of most likelihood. counts : (bins,) by RATE_EDGES. shot : as of
    DarkLaw.

    uneven, hot : whether the pixels have a law, and whether some are hot."""
    return _fitted(counts.astype(float).tobytes(), float(shot), uneven, hot)


@lru_cache(maxsize=16)  # of a few splits: a name, its value and a median need the same
def _fitted(of_counts: bytes, shot: float, uneven: bool, hot: bool) -> DarkLaw:
    counts = np.frombuffer(of_counts)
    wide = max(quantile(counts, 0.9), 1.0)
    if not hot:
        used = np.array([True, uneven, uneven, False, False])
        sizes = [(wide / 2, 0.8), (0.1, 1.6)] if uneven else [(1.0, 1.0)]
        starts = [[size, sigma, LEAST_HOT, FAR] for size, sigma in sizes]
        found, shift = [], 0.0
    else:
        best = _fitted(of_counts, shot, uneven, False)
        used = np.array([True, uneven, uneven, True, True])
        high = max(quantile(counts, 0.999), FAR)
        # Without hot pixels, those that are make the law of all a wide one.
        sizes = [(best.rate or 1.0, best.log_sigma)]
        sizes += [(wide / 2, 0.8)] if uneven else []
        starts = [[*each, n, high] for each in sizes for n in (1e-2, 1e-4)]
        found, shift = [best], best.shift
    for start in starts:
        found.append(_climbed(counts, np.array([shift, *np.log(start)]), used, shot))
    return max(found, key=lambda law: law.nats)


def with_hot(counts: Array, shot: float, fraction: float, hot_rate: float) -> DarkLaw:
    """Return the law of most likelihood, less what it costs, with hot pixels that are
    known to HOT_ERROR. fraction, hot_rate : as of DarkLaw; others as of fitted."""
    counts = counts.astype(float)
    best = fitted(counts, shot, uneven=True, hot=True)
    weights, free = np.array([0, 0, 0, 1, 1]) / HOT_ERROR**2, np.ones(5, bool)
    stated = replace(best, fraction=fraction, hot_rate=hot_rate)
    near = _climbed(counts, stated.numbers, free, shot, FIXED * weights)
    return _climbed(counts, near.numbers, free, shot, weights)


def quantile(counts: Array, share: float) -> float:
    """Return below which rate, over the noise, a share of the counts is."""
    total = np.append(0.0, counts.cumsum())
    return float(np.interp(share * total[-1], total, RATE_EDGES))


def _climbed(
    counts: Array, start: Array, free: Array, shot: float, weights: Array = NOTHING
) -> DarkLaw:
    """Fisher scoring with damping. start : shift, and logarithms of the others.
    free : (5,) of them, what is searched for; without, a rate or a fraction is 0.
    weights : (5,) of a normal prior about the start, over its variance."""
    low, high = LOW.copy(), HIGH
    deviation = (quantile(counts, MIDDLE[1]) - quantile(counts, MIDDLE[0])) / 2
    low[4] += np.log(max(deviation, 1.0))
    about = x = np.clip(start, low, high)
    known = np.array([True, free[1], True, free[3], True])
    # Bins without a count, at both ends, are one.
    first, last = np.flatnonzero(counts)[[0, -1]]
    inner = np.arange(max(first, 1), min(last + 2, len(RATE_EDGES) - 1))
    edges = RATE_EDGES[np.r_[0, inner, len(RATE_EDGES) - 1]]
    counts = np.add.reduceat(counts, np.r_[0, inner])

    def law_values(x: Array) -> Array:
        found: Array = np.append(x[:1], np.exp(x[1:])) * known
        return found

    def shares(x: Array) -> Array:
        found = shares_of(law_values(x), shot, edges)
        return np.maximum(found, LEAST_SHARE)

    def nats_at(x: Array, expected: Array) -> float:
        return float(counts @ np.log(expected) - weights @ (x - about) ** 2 / 2)

    expected = shares(x)
    nats = nats_at(x, expected)
    damping = 1e-3
    information = np.eye(int(free.sum()))
    for _ in range(ROUNDS):
        by = slopes_of(law_values(x), shot, edges)[free] * (expected > LEAST_SHARE)
        score = by @ (counts / expected) - (weights * (x - about))[free]
        information = counts.sum() * (by / expected) @ by.T
        information += np.diag(weights[free])
        own = np.diagonal(information)
        damped = information + np.diag(damping * own + 1e-9)
        trial = x.copy()
        trial[free] += np.linalg.solve(damped, score)
        trial = np.clip(trial, low, high)
        after = shares(trial)
        better = nats_at(trial, after)
        if better < nats:
            damping = max(damping, 1e-4) * DAMPED
            if damping > 1e9:
                break
            continue
        gain, x, expected, nats = better - nats, trial, after, better
        damping *= FREED
        if gain < DONE:
            break
    errors = np.zeros(5)
    scale = np.sqrt(np.maximum(np.diagonal(information), 1e-9))
    roots, vectors = np.linalg.eigh(information / np.outer(scale, scale))
    inverse = (vectors**2 / np.maximum(roots, 1e-6)).sum(axis=1)
    errors[free] = np.sqrt(inverse) / scale
    values = law_values(x)
    errors[1:] *= values[1:]
    shift, rate, log_sigma, fraction, hot_rate = map(float, values)
    return DarkLaw(shift, rate, log_sigma, fraction, hot_rate, errors, nats, shot)


def median_of(counts: Array, shot: float = 0.0) -> tuple[float, float]:
    """Return the median of the rates and its standard error, over the noise: 0 is what
    they are counted from. Both are 0 where most pixels are not shown to differ.

    With noise, the median is measured; how far noise moves it is by the law, and known
    to OTHER_LAW. Of a law that is narrower than noise log_sigma is hardly known, and by
    it the median: then they are averaged over it, by likelihood."""
    even = fitted(counts, shot, uneven=False, hot=True)
    best = fitted(counts, shot, uneven=True, hot=True)
    if best.nats - even.nats < LEAST_NATS:
        return 0.0, 0.0
    laws = [best]
    if best.errors[2] >= KNOWN * best.log_sigma:
        free = np.array([True, True, False, best.fraction > 0, best.fraction > 0])
        same_spread = np.array([0, 1, -1, 0, 0])
        laws = []
        for log_sigma in LOG_SIGMAS:  # of the spread the tail says how much is skew
            again = best.numbers + np.log(best.log_sigma / log_sigma) * same_spread
            laws.append(_climbed(counts, again, free, shot))
    nats = np.array([law.nats for law in laws])
    weights = np.exp(nats - nats.max())
    weights /= weights.sum()
    each = np.array([_noisy_medians(counts, law) for law in laws])
    moved = np.array([law.shift for law in laws]) - each[:, 0]  # by noise, back
    medians = each[:, 1] + moved
    squares = medians**2 + np.array([law.errors[0] for law in laws]) ** 2
    median = float(weights @ medians)
    variance = max(float(weights @ squares) - median**2, 0.0)
    return median, math.hypot(math.sqrt(variance), OTHER_LAW * float(weights @ moved))


def _noisy_medians(counts: Array, law: DarkLaw) -> tuple[float, float]:
    """Return the medians with noise: of a law, and of counts, by how far about there
    more of them are below than the law has."""
    middle = quantile(law.shares, 0.5)
    below, expected = (
        np.interp(middle + AROUND, RATE_EDGES, np.append(0.0, one.cumsum()) / one.sum())
        for one in (counts, law.shares)
    )
    density = (expected[-1] - expected[0]) / (AROUND[-1] - AROUND[0])
    return middle, middle + float((expected - below).mean()) / density


def shares_of(values: Array, shot: float, edges: Array = RATE_EDGES) -> Array:
    """Return the expected share of each bin between edges.

    values : shift, rate, log_sigma, fraction, hot rate; the noise is 1 at a rate
    of 0. shot : as of DarkLaw."""
    away, wide = _places(values, shot)
    fraction, hot = values[3:]
    sign = _sign(edges)
    cold = ndtr(sign * (edges[:, None] - away) / wide) @ WEIGHTS
    warm = cold if fraction == 0 else _with_hot(edges, hot, away)[0]
    total: Array = np.diff(((1 - fraction) * cold + fraction * warm) * sign[:, 0])
    total[np.diff(sign[:, 0]) < 0] += 1.0
    return total


def _sign(edges: Array) -> Array:
    """Return (edges, 1), 1 where what is below an edge is the less, else -1: of edges
    above 0 what is above them is counted, so that far bins are not lost in 1."""
    return np.where(edges < 0, 1.0, -1.0)[:, None]


def _places(values: Array, shot: float) -> tuple[Array, Array]:
    """Return (nodes,) rates of most pixels, and their noise: between two nodes the law
    is even, as wide as their distance. Without a law the noise is 1."""
    shift, rate, log_sigma = values[:3]
    shot = shot if rate else 0.0
    away = shift + rate * np.expm1(log_sigma * NODES)
    apart = rate * log_sigma * np.exp(log_sigma * NODES) * (NODES[1] - NODES[0])
    return away, np.sqrt(np.maximum(1 + shot * away, LEAST_NOISE) + apart**2 / 12)


def slopes_of(values: Array, shot: float, edges: Array) -> Array:
    """Return (5, bins) how shares_of moves with the shift and with the logarithms of
    the other values."""
    _, rate, log_sigma, fraction, hot = values
    away, wide = _places(values, shot)
    grown = rate * np.exp(log_sigma * NODES)
    apart = log_sigma * grown * (NODES[1] - NODES[0])
    of_away = np.array([np.ones_like(away), grown - rate, log_sigma * NODES * grown])
    of_apart = np.array([0 * apart, apart, apart * (1 + log_sigma * NODES)])
    is_shot = shot * (1 + shot * away > LEAST_NOISE) if rate else 0.0
    of_wide = (is_shot * of_away / 2 + apart * of_apart / 12) / wide
    z = (edges[:, None] - away) / wide
    density = np.exp(-(z**2) / 2) / math.sqrt(2 * math.pi)
    cold = -density @ (WEIGHTS / wide * of_away).T
    cold -= (z * density) @ (WEIGHTS / wide * of_wide).T
    found = np.zeros((5, len(edges)))
    found[:3] = (1 - fraction) * cold.T
    if fraction > 0:
        sign = _sign(edges)
        warm, tail, of_hot = _with_hot(edges, hot, away)
        weights = WEIGHTS[::EACH] / WEIGHTS[::EACH].sum()
        found[:3] -= fraction * (tail / hot @ (weights * of_away[:, ::EACH]).T).T
        found[3] = fraction * sign[:, 0] * (warm - ndtr(sign * z) @ WEIGHTS)
        found[4] = fraction * of_hot
    total: Array = np.diff(found, axis=1)
    return total


def _with_hot(x: Array, hot: float, away: Array) -> tuple[Array, Array, Array]:
    """Return the share of noise plus an exponential of mean @hot, beyond where each of
    the others is, of which few do, that is below x, or above it (_sign); by how much
    less is below than of the noise alone, for each; the slope of what is below by the
    logarithm of @hot."""
    weights = WEIGHTS[::EACH] / WEIGHTS[::EACH].sum()
    z = x[:, None] - away[None, ::EACH]
    inner = (1 / hot - z) / math.sqrt(2)
    normal = np.exp(-(z**2) / 2)
    tail = 0.5 * erfcx(np.maximum(inner, -25)) * normal
    far = inner < -20
    tail = np.where(far, np.exp(np.clip(0.5 / hot**2 - z / hot, -700, 0)), tail)
    of_hot = tail * (z / hot - 1 / hot**2) + normal / math.sqrt(2 * math.pi) / hot
    sign = _sign(x)
    return (ndtr(sign * z) - sign * tail) @ weights, tail, -of_hot @ weights

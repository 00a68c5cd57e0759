# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Dark current of pixels: its spread, hot pixels, and an amplifier's glow.

A pixel's rate above the median is log-normal, a few pixels' exponential besides, and
what was measured has Gaussian noise. Source: R. L. Baer, Proc. SPIE 6068, 2006
(log-normal); R. Widenhorn et al., Proc. SPIE 4669, 2002 (tails).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize
from scipy.special import erfcx, ndtr

from cg2raw.calibration.measured import FLOOR, Measured
from cg2raw.calibration.robust import Array

# Bins of rates over their noise; as fine as the laws are, out to all that can be.
SIDE = np.geomspace(0.25, 1e5, 121)
EDGES = np.concatenate([-SIDE[::-2], SIDE])
NODES = np.linspace(-5.5, 5.5, 221)  # of the normal that the log-normal is made of
WEIGHTS = np.exp(-(NODES**2) / 2) / np.exp(-(NODES**2) / 2).sum()
FAR = 20.0  # times the noise, where hot pixels are looked for first
SHARES = (0.9, 0.99, 0.999, 0.9999)  # quantiles that are told
MOST_LOG_SIGMA, MOST_HOT = 3.0, 0.2  # as the registry bounds them
LEAST_HOT = 1e-7  # share of hot pixels that is tried
LEAST_NATS = 10.0  # of evidence for a law of two parameters
FALL95 = 1.92  # nats by which the likelihood falls to its limit of 95 %
AT_BOUND = 0.01  # relative, to a bound of the search

# A law that ends here is a normal: noise that is wider than it was taken for.
LEAST_LOG_SIGMA = 0.02


@dataclass(frozen=True)
class DarkSpread:
    """Rates of pixels above the median, DN/s.

    rate, log_sigma : of rate * (exp(log_sigma n) - 1), n normal. fraction, hot_rate :
    share of hot pixels, and the mean of their exponential law.
    quantiles : {share: DN/s}, as measured. noise : DN/s, of a pixel's rate.
    above : {DN/s: share of pixels beyond it}, at 5, 20 and 100 times the noise.
    most_hot : share of hot pixels, of a mean rate of 20 times the noise, that there may
    be (95 %)."""

    rate: Measured
    log_sigma: Measured
    fraction: Measured
    hot_rate: Measured
    quantiles: dict[float, float]
    noise: float
    above: dict[float, float]
    spread_nats: float
    hot_nats: float
    most_hot: float

    @property
    def has_too_many_hot(self) -> bool:
        """Whether the share of hot pixels is at the end of the search: a limit, as of
        the other numbers none was measured."""
        return self.fraction.value > (1 - AT_BOUND) * MOST_HOT

    @property
    def has_hot(self) -> bool:
        """Whether there are hot pixels beyond chance, as many as are searched for."""
        seen = self.hot_nats >= LEAST_NATS and self.fraction.stands_out
        return seen and not self.has_too_many_hot

    @property
    def is_uneven(self) -> bool:
        """Whether the others' rates differ beyond chance, and not as a normal law's,
        which would be noise that is wider than it was taken for."""
        log_sigma, least, most = self.log_sigma.value, LEAST_LOG_SIGMA, MOST_LOG_SIGMA
        is_wide = (self.rate.value * log_sigma) ** 2 > FLOOR * self.noise**2
        inside = least * (1 + AT_BOUND) < log_sigma < most * (1 - AT_BOUND)
        seen = self.spread_nats >= LEAST_NATS and self.rate.stands_out
        return is_wide and inside and seen and not self.has_too_many_hot

    @property
    def hot_words(self) -> str:
        """Say what is known of a share of hot pixels that was not measured."""
        if self.has_hot:
            return ""
        if self.has_too_many_hot:
            return f"more than {MOST_HOT:.0%}"
        most = f"{100 * self.most_hot:.2g} % of a mean of {FAR * self.noise:.3g} DN/s"
        return f"not found; below {most}"

    @property
    def uneven_words(self) -> str:
        """Say why rates of the others were not measured."""
        if self.is_uneven:
            return ""
        return "not shown among so many hot" if self.has_too_many_hot else "not found"


def dark_spread(excess: Array, noise: float) -> DarkSpread:
    """Return the law of rates above their median by maximum likelihood.

    excess : (N,) DN/s, median 0. noise : DN/s, standard deviation by temporal noise."""
    counts = np.histogram(excess / noise, EDGES)[0].astype(float)
    wide, far = (max(float(q), 1.0) for q in np.quantile(excess / noise, (0.9, 0.999)))
    start = np.array([wide / 2, 0.8, 1e-3, max(far, FAR)])
    flat = _fitted(counts, [start], (False, True))
    cold = _fitted(counts, [start], (True, False))
    ends = [
        np.array([*start[:2], *flat[0][2:]]),
        np.array([*cold[0][:2], *start[2:]]),
    ]
    both = _fitted(counts, ends, (True, True))
    values, errors = both[0], both[2]
    rate, log_sigma, fraction, hot = (
        Measured(v * unit, e * unit, words)
        for v, e, unit, words in zip(
            values,
            errors,
            (noise, 1, 1, noise),
            ("DN/s", "1", "1", "DN/s"),
            strict=True,
        )
    )
    return DarkSpread(
        rate,
        log_sigma,
        fraction,
        hot,
        dict(zip(SHARES, map(float, np.quantile(excess, SHARES)), strict=True)),
        noise,
        {k * noise: float(np.mean(excess > k * noise)) for k in (5, 20, 100)},
        both[1] - flat[1],
        both[1] - cold[1],
        most_hot(counts, both[0]),
    )


def most_hot(counts: Array, values: Array) -> float:
    """Return the share of hot pixels, of FAR times the noise, at which the likelihood
    has fallen to its limit of 95 %: the error by its curvature is none at a bound.

    values : of the fit, rate and log_sigma first; the noise is 1."""

    def lost(share: float) -> float:
        shares = shares_of(np.array([*values[:2], share, FAR]))
        return -float(counts @ np.log(np.maximum(shares, 1e-12)))

    tried = np.geomspace(LEAST_HOT, MOST_HOT, 60)
    losses = np.array([lost(float(share)) for share in tried])
    best = int(losses.argmin())
    beyond = np.flatnonzero(losses[best:] > losses[best] + FALL95)
    return float(tried[best + beyond[0]]) if beyond.size else MOST_HOT


def _fitted(
    counts: Array, starts: Sequence[Array], used: tuple[bool, bool]
) -> tuple[Array, float, Array]:
    """Return (values, log likelihood, errors) of log-normal and hot pixels.

    Values in units of the noise; an unused part has rate or fraction 0. starts : where
    the search begins, in turn; the likeliest end counts."""
    low = np.log([1e-3, LEAST_LOG_SIGMA, LEAST_HOT, 1.0])
    high = np.log([1e3, MOST_LOG_SIGMA, MOST_HOT, 1e5])

    def unpacked(x: Array) -> Array:
        values: Array = np.exp(np.clip(x, low, high))
        values[0] *= used[0]
        values[2] *= used[1]
        return values

    def loss(x: Array) -> float:
        beyond = np.maximum(x - high, 0) + np.maximum(low - x, 0)
        share = np.maximum(shares_of(unpacked(x)), 1e-12)
        return -float(counts @ np.log(share)) + 1e3 * float(beyond @ beyond)

    best = None
    for start in starts:
        first = np.clip(np.log(np.maximum(start, 1e-12)), low, high)
        for step in STEPS:  # once more from where it ended: a simplex may collapse
            corners = np.vstack([first, first + step * np.eye(len(first))])
            options = {**OPTIONS, "initial_simplex": corners}
            found = minimize(loss, first, method="Nelder-Mead", options=options)
            first = found.x
        if best is None or found.fun < best.fun:
            best = found
    assert best is not None
    errors = _errors(loss, best.x) if all(used) else np.zeros(4)
    values = unpacked(best.x)
    return values, -float(best.fun), errors * values


OPTIONS = {"maxfev": 600, "xatol": 1e-3, "fatol": 1e-2}
STEPS = (0.7, 0.2)  # of the first simplex, in logarithms


def shares_of(values: Array) -> Array:
    """Return the expected share of each bin between EDGES.

    values : rate, log_sigma, fraction, hot rate; the noise is 1."""
    rate, log_sigma, fraction, hot = values
    shift = rate * np.expm1(log_sigma * NODES)
    cold = ndtr(EDGES[:, None] - shift[None]) @ WEIGHTS
    warm = cold if fraction == 0 else _with_hot(EDGES, hot, shift)
    together = (1 - fraction) * cold + fraction * warm
    total: Array = np.diff(together)
    return total


def _with_hot(x: Array, hot: float, shift: Array) -> Array:
    """Return the distribution of noise plus an exponential of mean @hot, at the centre
    of the others' law (hot ones are far off it)."""
    z = x - float(WEIGHTS @ np.minimum(shift, 1.0))
    inner = (1 / hot - z) / math.sqrt(2)
    tail = 0.5 * erfcx(np.maximum(inner, -25)) * np.exp(-(z**2) / 2)
    far = inner < -20
    tail = np.where(far, np.exp(np.clip(0.5 / hot**2 - z / hot, -700, 0)), tail)
    found: Array = ndtr(z) - tail
    return found


def _errors(loss: object, at: Array) -> Array:
    """Return standard errors by the curvature of the loss, numerically."""
    size, step = len(at), 0.02
    assert callable(loss)
    hessian = np.zeros((size, size))
    centre = loss(at)
    for i in range(size):
        for j in range(i, size):
            a, b = np.zeros((2, size))
            a[i], b[j] = step, step
            if i == j:
                hessian[i, i] = (loss(at + a) + loss(at - a) - 2 * centre) / step**2
            else:
                mixed = loss(at + a + b) + loss(at - a - b)
                mixed -= loss(at + a - b) + loss(at - a + b)
                hessian[i, j] = hessian[j, i] = mixed / (4 * step**2)
    values, vectors = np.linalg.eigh(hessian)
    covariance = (vectors / np.maximum(values, 1e-3)) @ vectors.T
    found: Array = np.sqrt(np.maximum(np.diag(covariance), 0))
    return found

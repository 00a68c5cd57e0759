# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Darks: what they show besides the figures of the fit.

Source: EMVA Standard 1288, release 4.0, section on dark current (doubling temperature);
tails: K. Wei et al., IEEE Trans. PAMI 44(11), 2022 (Tukey lambda)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import beta

from cg2raw.calibration.fitting import Fitted, of_all
from cg2raw.calibration.measured import Array, Measured
from cg2raw.calibration.seen import Seen
from cg2raw.calibration.structure import BiasStructure, Glow, bias_structure, glow
from cg2raw.model.dark_law import (
    FAR,
    LEAST_HOT,
    LEAST_LOG_SIGMA,
    LEAST_NATS,
    MOST_HOT,
    MOST_LOG_SIGMA,
    DarkLaw,
    fitted,
    median_of,
    nats_of,
    quantile,
)
from cg2raw.normal import CI95
from cg2raw.statistics.constant import BINS_PER_SIGMA, DarkRates
from cg2raw.statistics.dark_rates import slope_of

Map = NDArray[np.float32]
# Of the noise variance of rates, which is not known better than that, by the cut at 4
# sigma and by pixels that are not alike.
FLOOR = 0.01
FOURTH_OF_ROUNDING = -1.2  # its fourth cumulant, of the square of its variance
LEAST_NOISE = 12.0  # variance, of that of rounding, which shapes the tails below it
# Excess kurtosis that pixels bring whose variances differ by a quarter: 3 times 0.25^2.
TAILS_FLOOR = 0.19
HISTOGRAM = np.linspace(-8, 8, 129)  # edges, standard deviations of the difference
LEAST_LAMBDA = -0.2  # of Tukey's distribution; at -0.25 its kurtosis has no bound
SHARES = (0.9, 0.99, 0.999, 0.9999)  # quantiles that are told
AT_BOUND = 0.01  # relative, to a bound of the search


@dataclass(frozen=True)
class DarkSpread:
    """Rates of pixels above the median, DN/s.

    median : by how much that is above the mean of pixels that are not masked.
    rate, log_sigma : of rate * (exp(log_sigma n) - 1), n normal. fraction, hot_rate :
    share of hot pixels, and the mean of their exponential law.
    quantiles : {share: DN/s}, as measured. noise : DN/s, of a pixel's rate.
    most_hot : share of hot pixels, of a mean rate of 20 times the noise, that there may
    be (95 %)."""

    median: Measured
    rate: Measured
    log_sigma: Measured
    fraction: Measured
    hot_rate: Measured
    quantiles: dict[float, float]
    noise: float
    spread_nats: float
    hot_nats: float
    most_hot: float

    @property
    def has_most_hot(self) -> bool:
        """Whether there are as many hot pixels as are searched for, or more."""
        return self.fraction.value > (1 - AT_BOUND) * MOST_HOT

    @property
    def has_too_many_hot(self) -> bool:
        """Whether the share of hot pixels is at the end of the search, or the law of
        the others is so wide that it has hot ones, too: no number was measured."""
        is_wide = self.log_sigma.value > (1 - AT_BOUND) * MOST_LOG_SIGMA
        return self.has_most_hot or (is_wide and self.spread_nats >= LEAST_NATS)

    @property
    def has_hot(self) -> bool:
        """Whether there are hot pixels beyond chance, as many as are searched for."""
        seen = self.hot_nats >= LEAST_NATS and self.fraction.stands_out
        return seen and not self.has_too_many_hot

    @property
    def is_uneven(self) -> bool:
        """Whether the others' rates differ beyond chance, and not as a normal law's,
        which would be noise that is wider than it was taken for."""
        log_sigma = self.log_sigma.value
        is_wide = (self.rate.value * log_sigma) ** 2 > FLOOR * self.noise**2
        is_skew = log_sigma > LEAST_LOG_SIGMA * (1 + AT_BOUND)
        seen = self.spread_nats >= LEAST_NATS and self.rate.stands_out
        return is_wide and is_skew and seen and not self.has_too_many_hot

    @property
    def hot_words(self) -> str:
        """What is known of a share of hot pixels that was not measured."""
        if self.has_hot:
            return ""
        if self.has_most_hot:
            return f"more than {MOST_HOT:.0%}"
        if self.has_too_many_hot:
            return "not told from the others, which are as uneven"
        most = f"{100 * self.most_hot:.2g} % of a mean of {FAR * self.noise:.3g} DN/s"
        return f"not found; below {most}"

    @property
    def uneven_words(self) -> str:
        """Why rates of the others were not measured."""
        if self.is_uneven:
            return ""
        return "not shown among so many hot" if self.has_too_many_hot else "not found"


@dataclass(frozen=True)
class Tails:
    """excess_kurtosis : 0 of a normal distribution; None where rounding shapes it.
    tukey_lambda : of that kurtosis. histogram : of differences of two of @frames darks
    (HISTOGRAM). variance : (sites, blocks) DN^2 of a pixel, and error : (blocks,), the
    relative one of their mean."""

    excess_kurtosis: Measured | None
    tukey_lambda: float | None
    histogram: Array
    frames: int
    variance: Array
    error: Array

    @property
    def are_heavy(self) -> bool:
        """Whether the distribution is not the normal one, beyond the floor."""
        k = self.excess_kurtosis
        return k is not None and k.stands_out and abs(k.value) > TAILS_FLOOR


@dataclass(frozen=True)
class DarkCurrent:
    """Dark current of the median pixel.

    rates : (temperature or None, DN/s) of each set point, that of most frames first.
    doubling : K. points : (exposure time, s, DN above black, place in rates)."""

    rates: tuple[tuple[float | None, Measured], ...]
    doubling: Measured | None
    points: tuple[tuple[float, float, int], ...]

    @property
    def rate(self) -> Measured:
        """At the set point of most frames, DN/s."""
        return self.rates[0][1]


@dataclass(frozen=True, kw_only=True)
class DarkResults:
    """What darks show. offset, rate : (H, W) of each pixel, DN above black, and DN/s
    but for a constant."""

    tails: Tails | None = None
    structure: BiasStructure | None = None
    dark: DarkCurrent | None = None
    spread: DarkSpread | None = None
    glow: Glow | None = None
    offset: Map | None = field(default=None, repr=False)
    rate: Map | None = field(default=None, repr=False)


def read_darks(seen: Seen, fit: Fitted, black: NDArray[np.float64]) -> DarkResults:
    """Return what darks show. black : (sites,) DN."""
    if not seen.darks:
        return DarkResults()
    repeated = [number for number in seen.darks if seen.repeats(number)]
    gain = of_all(fit.figures, "gain")
    spread, shine, rate = None, None, None
    if fit.lost != "cut":
        for rates in seen.statistics.rates:
            if not rates.split:
                spread = dark_spread(rates, 1 / gain.value if gain else 0.0)
        # But for a constant; none where the law of rates is not known either.
        if (slope := slope_of(seen.statistics, "")) is not None:
            rate = seen.sum_of(slope.weights)
            excluded = seen.statistics.excluded
            unknown = False if excluded is None else excluded
            shine = glow(np.where(unknown, np.nan, rate))
    return DarkResults(
        tails=tails_of(seen, repeated[0]) if repeated and not fit.lost else None,
        structure=None if fit.lost else bias_structure(seen),
        dark=dark_current(seen, fit, spread, float(black.mean())),
        spread=spread,
        glow=shine,
        offset=offset_map(seen, black),
        rate=rate,
    )


def offset_map(seen: Seen, black: NDArray[np.float64]) -> Map:
    """Return (H, W) DN, by how much the shortest darks are above black, (sites,) DN."""
    groups = seen.statistics.groups
    own = groups[seen.shortest[0]].temperature
    found = seen.mean_over([n for n in seen.shortest if groups[n].temperature == own])
    found -= seen.sites.spread(black, found.shape)
    return found


def dark_current(
    seen: Seen, fit: Fitted, spread: DarkSpread | None, black: float
) -> DarkCurrent | None:
    """Return the dark current of each set point; None of one exposure time.

    The law of rates tells how far the median pixel's is off the mean; it is in
    proportion at other temperatures. black : DN."""
    mean = of_all(fit.figures, "dark current")
    if mean is None:
        return None
    shift = spread.median if spread is not None else Measured(0.0, 0.0, "DN/s")
    error = math.hypot(mean.standard_error, shift.standard_error)
    median = Measured(mean.value + shift.value, error, "DN/s")
    ratio = median.value / mean.value if mean.stands_out else 1.0
    others = {split: one.scaled(ratio, "DN/s") for split, one in fit.others.items()}
    groups, rates, points = seen.statistics.groups, [], []
    for place, (split, rate) in enumerate({"": median, **others}.items()):
        own = [n for n in seen.darks if groups[n].split == split]
        longer = [n for n in own if n not in seen.shortest] or own
        known = [t for n in longer if (t := groups[n].temperature) is not None]
        rates.append((float(np.mean(known)) if known else None, rate))
        for n in own:
            above = float(seen.levels(n).mean()) - black
            points.append((seen.time(n), ratio * above, place))
    return DarkCurrent(tuple(rates), doubling_of(rates), tuple(points))


def doubling_of(rates: Sequence[tuple[float | None, Measured]]) -> Measured | None:
    """Return by how many kelvin the rate doubles, of the two farthest set points whose
    rates stand out."""
    known = sorted(
        (t, rate.value, rate.standard_error / rate.value)
        for t, rate in rates
        if t is not None and rate.stands_out and rate.value > 0
    )
    if not known or known[-1][1] <= known[0][1]:
        return None
    (cold, slow, *_), (warm, fast, _) = known[0], known[-1]
    rise = math.log(fast / slow)
    value = (warm - cold) * math.log(2) / rise
    return Measured(value, value * math.hypot(known[0][2], known[-1][2]) / rise, "K")


def tails_of(seen: Seen, number: int) -> Tails:
    """Return the tails of a group of several darks of one exposure; no kurtosis where
    rounding shapes them.

    Cumulants add up: a difference of two has half the excess kurtosis of one, and
    rounding to codes, where noise spreads over them, adds its own."""
    planes, rounding = seen.statistics.planes, seen.sites.rounding
    variance, each = seen.statistics.block_noise(number)
    error = np.sqrt(np.mean(each**2, 0) / len(each))
    total = float(seen.statistics.variance(number).mean())
    kurtosis = shape = None
    if total >= LEAST_NOISE * rounding:
        excess = float(np.mean([plane.fourth[number] for plane in planes])) - 3
        fourth = FOURTH_OF_ROUNDING * rounding**2
        value = (2 * excess * total**2 - fourth) / (total - rounding) ** 2
        pixels = float((2 / error**2).sum())  # of all differences
        kurtosis = Measured(value, 2 * math.sqrt(24 / pixels), "1")
        shape = lambda_of(value)
    width = int(round((HISTOGRAM[1] - HISTOGRAM[0]) * BINS_PER_SIGMA))
    residuals = sum(plane.residuals[number] for plane in planes)
    half = residuals[: len(HISTOGRAM) // 2 * width].reshape(-1, width).sum(1) / 2
    histogram = np.concatenate([half[::-1], half])
    frames = int(seen.statistics.frames[number])
    return Tails(kurtosis, shape, histogram, frames, variance, error)


def lambda_of(excess_kurtosis: float) -> float:
    """Return the lambda, LEAST_LAMBDA to 0.5, of Tukey's law with such tails.

    Source: B. Joiner, J. Rosenblatt, J. Am. Stat. Assoc. 66(334), 1971 (moments)."""
    grid = np.linspace(LEAST_LAMBDA, 0.5, 140)  # without 0, where moments are limits
    one, two, three = grid + 1, 2 * grid + 1, 3 * grid + 1
    square = 2 / two - 2 * beta(one, one)
    fourth = 2 / (4 * grid + 1) - 8 * beta(three, one) + 6 * beta(two, two)
    return float(np.interp(-excess_kurtosis, 3 - fourth / square**2, grid))


def dark_spread(rates: DarkRates, gain: float) -> DarkSpread:
    """Return the law of rates by maximum likelihood.

    gain : DN^2 of noise for each DN of charge, 0 where it is not known."""
    counts, noise = rates.counts.astype(float), rates.noise
    shot = rates.shot(gain)
    flat = fitted(counts, shot, uneven=False, hot=True)
    cold = fitted(counts, shot, uneven=True, hot=False)
    both = fitted(counts, shot, uneven=True, hot=True)
    _, of_rate, of_sigma, of_share, of_hot = map(float, both.errors)
    median, error = median_of(counts, shot)
    middle = quantile(counts, 0.5)
    return DarkSpread(
        Measured(median * noise, error * noise, "DN/s"),
        Measured(both.rate * noise, of_rate * noise, "DN/s"),
        Measured(both.log_sigma, of_sigma, "1"),
        Measured(both.fraction, of_share, "1"),
        Measured(both.hot_rate * noise, of_hot * noise, "DN/s"),
        {share: (quantile(counts, share) - middle) * noise for share in SHARES},
        noise,
        both.nats - flat.nats,
        both.nats - cold.nats,
        most_hot(counts, both),
    )


def most_hot(counts: Array, law: DarkLaw) -> float:
    """Return the share of hot pixels, of FAR times the noise, at which the likelihood
    has fallen to its limit of 95 %: the error by its curvature is none at a bound."""
    tried = np.geomspace(LEAST_HOT, MOST_HOT, 60)
    laws = (replace(law, fraction=float(share), hot_rate=FAR) for share in tried)
    nats = np.array([nats_of(counts, one) for one in laws])
    best = int(nats.argmax())
    beyond = np.flatnonzero(nats[best:] < nats[best] - CI95**2 / 2)
    return float(tried[best + beyond[0]]) if beyond.size else MOST_HOT

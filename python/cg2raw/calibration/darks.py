# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Darks: what they show besides the figures of the fit.

Source: EMVA Standard 1288, release 4.0, section on dark current (doubling temperature);
tails: K. Wei et al., IEEE Trans. PAMI 44(11), 2022 (Tukey lambda)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.stats import tukeylambda

from cg2raw.calibration.dark_spread import DarkSpread, dark_spread
from cg2raw.calibration.fitting import Fitted, of_all
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.robust import Array
from cg2raw.calibration.seen import Seen
from cg2raw.calibration.structure import BiasStructure, Glow, bias_structure, glow
from cg2raw.statistics.constant import BINS_PER_SIGMA
from cg2raw.statistics.dark_rates import slope_of

Map = NDArray[np.float32]
FOURTH_OF_ROUNDING = -1.2  # its fourth cumulant, of the square of its variance
LEAST_NOISE = 12.0  # variance, of that of rounding, which shapes the tails below it
# Excess kurtosis that pixels bring whose variances differ by a quarter: 3 times 0.25^2.
TAILS_FLOOR = 0.19
HISTOGRAM = np.linspace(-8, 8, 129)  # edges, standard deviations of the difference
LEAST_LAMBDA = -0.2  # of Tukey's distribution; at -0.25 its kurtosis has no bound


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
        per_electron = 1 / gain.value if gain else 0.0
        for rates in seen.statistics.rates:
            if not rates.split:
                spread = dark_spread(rates, per_electron)
        rate = rate_map(seen)
        if rate is not None:
            unknown = False if seen.counting is None else ~seen.counting
            shine = glow(np.where(unknown, np.nan, rate))
    offset = seen.mean_of(seen.shortest[0])
    offset -= seen.sites.spread(black, offset.shape)
    return DarkResults(
        tails=tails_of(seen, repeated[0]) if repeated and not fit.lost else None,
        structure=None if fit.lost else bias_structure(seen),
        dark=dark_current(seen, fit, spread, float(black.mean())),
        spread=spread,
        glow=shine,
        offset=offset,
        rate=rate,
    )


def rate_map(seen: Seen) -> Map | None:
    """Return (H, W) DN/s, the slope of pixels over exposure time but for a constant;
    None where the law of rates is not known either."""
    slope = slope_of(seen.statistics, "")
    if slope is None:
        return None
    used = np.flatnonzero(slope.weights)
    return sum(
        (np.float32(slope.weights[g]) * seen.mean_of(int(g)) for g in used[1:]),
        np.float32(slope.weights[used[0]]) * seen.mean_of(int(used[0])),
    )


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
    splits = ["", *fit.others]
    groups = seen.statistics.groups
    rates = [median, *(one.scaled(ratio, "DN/s") for one in fit.others.values())]
    temperatures = []
    for split in splits:
        own = [n for n in seen.darks if groups[n].split == split]
        longer = [n for n in own if n not in seen.shortest] or own
        known = [t for n in longer if (t := groups[n].temperature) is not None]
        temperatures.append(float(np.mean(known)) if known else None)
    listed = tuple(zip(temperatures, rates, strict=True))
    points = tuple(
        (
            seen.time(n),
            ratio * (float(seen.levels(n).mean()) - black),
            splits.index(groups[n].split),
        )
        for n in seen.darks
        if groups[n].split in splits
    )
    return DarkCurrent(listed, _doubling(listed), points)


def _doubling(rates: Sequence[tuple[float | None, Measured]]) -> Measured | None:
    """Return by how many kelvin the rate doubles, of the two farthest set points whose
    rates stand out."""
    known = [(t, r) for t, r in rates if t is not None and r.stands_out and r.value > 0]
    if len(known) < 2:
        return None
    known.sort(key=lambda item: item[0])
    (cold, a), (warm, b) = known[0], known[-1]
    rise = math.log(b.value / a.value)
    if rise <= 0:
        return None
    value = (warm - cold) * math.log(2) / rise
    error = math.hypot(a.standard_error / a.value, b.standard_error / b.value)
    return Measured(value, value * error / rise, "K")


def tails_of(seen: Seen, number: int) -> Tails:
    """Return the tails of a group of several darks of one exposure."""
    noise, planes = seen.noise(number), seen.statistics.planes
    fourth = float(np.mean([plane.fourth[number] for plane in planes]))
    many = float(noise.pixels.sum()) * noise.pairs
    total = float(noise.site_variance.mean())
    kurtosis = _kurtosis(fourth - 3, total, many, seen.sites.rounding)
    in_blocks = np.maximum(noise.pixels.sum(0), 1)
    return Tails(
        kurtosis,
        None if kurtosis is None else lambda_of(kurtosis.value),
        signed_histogram(sum(plane.residuals[number] for plane in planes)),
        int(seen.statistics.frames[number]),
        noise.variance,
        np.sqrt(2 / (in_blocks * noise.pairs)),
    )


def signed_histogram(residuals: Array) -> Array:
    """Return how often a residual is between the edges of HISTOGRAM, by the counts of
    its size."""
    width = int(round((HISTOGRAM[1] - HISTOGRAM[0]) * BINS_PER_SIGMA))
    half = residuals[: len(HISTOGRAM) // 2 * width].reshape(-1, width).sum(1) / 2
    return np.concatenate([half[::-1], half])


def _kurtosis(
    of_difference: float, variance: float, pixels: float, rounding: float
) -> Measured | None:
    """Return the excess kurtosis of one frame; None where rounding shapes the tails.

    Cumulants add up: a difference of two has half the excess kurtosis of one, and
    rounding to codes, where noise spreads over them, adds its own. pixels : of all
    differences."""
    if variance < LEAST_NOISE * rounding:
        return None
    fourth = FOURTH_OF_ROUNDING * rounding**2
    inner = variance - rounding
    value = (2 * of_difference * variance**2 - fourth) / inner**2
    return Measured(value, 2 * math.sqrt(24 / pixels), "1")


def lambda_of(excess_kurtosis: float) -> float:
    """Return the lambda, LEAST_LAMBDA to 0.5, of Tukey's law with such tails."""
    grid = np.linspace(LEAST_LAMBDA, 0.5, 701)
    found = tukeylambda.stats(grid, moments="k")
    return float(np.interp(-excess_kurtosis, -found, grid))

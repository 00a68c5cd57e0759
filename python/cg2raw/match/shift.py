# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The distribution of shifts that makes one set of levels another.

Levels of frames, in stops, differ by their scenes and by their exposures: c = r + e.
The scenes of both sets are draws from one population, and exposures do not depend on
them, so the density of c is that of r convolved with that of e. Here e is normal, and
its median and standard deviation are those of the highest likelihood of the captures'
levels, which may be bounds: a frame of which more than half is white lies above one.
r is a kernel density of the renders' levels with their variance (Silverman, Density
Estimation, 1986, 6.4.1). Levels are counted on a grid, so that time and memory do not
depend on their number; all shifts are tried at once, by Fourier transforms."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri
from scipy.stats import chi2, t

Array = NDArray[np.float64]
Range = tuple[float, float]

STEP = 1 / 16  # stops between grid points
POINTS = 1024  # of the grid, which is a circle: 64 stops
FIRST = -40.0  # stops
SPREADS = np.concatenate(
    [np.arange(0, 1, 0.05), np.arange(1, 2, 0.1), np.arange(2, 6.01, 0.25)]
)
OUTLIERS = 0.01  # share of frames whose level tells nothing, as a covered lens
KERNEL = 0.2  # of its width by the rule of thumb for normal levels, 0.9: modes stay
DRAWS = 200  # of the bootstrap
LEVEL = 0.99  # of intervals
PROBABILITIES = np.linspace(0, 1, 21)
ENDS = 0.004  # probabilities that the first and the last quantile have


@dataclass(frozen=True)
class Levels:
    """Levels of frames, stops: known ones, and bounds of those that lie above (of white
    frames) or below (of black ones)."""

    known: Array
    above: Array
    below: Array

    def __len__(self) -> int:
        return len(self.known) + len(self.above) + len(self.below)

    @property
    def all(self) -> Array:
        """All levels, known ones and bounds."""
        return np.concatenate([self.known, self.above, self.below])

    def drawn(self, rng: np.random.Generator) -> "Levels":
        """Return as many levels, drawn from these with replacement."""
        parts = (self.known, self.above, self.below)
        which = rng.integers(0, len(self), len(self))
        ends = np.cumsum([0, *map(len, parts)])
        return Levels(
            *(
                part[which[(which >= low) & (which < high)] - low]
                for part, low, high in zip(parts, ends[:-1], ends[1:], strict=True)
            )
        )


@dataclass(frozen=True)
class Shift:
    """A distribution of shifts, stops.

    spread : standard deviation. quantiles : (probability, stops), 0 to 1. median_range,
    spread_range : intervals of 99 %."""

    median: float
    spread: float
    quantiles: tuple[tuple[float, float], ...]
    median_range: Range
    spread_range: Range


def shift_between(renders: Array, captures: Levels, seed: int = 0) -> Shift:
    """Return the Shift that makes renders' levels those of captures, whose scenes are
    other draws of one population; at least two of each."""
    median, spread = fitted(renders, captures)
    quantiles = normal_quantiles(median, spread)
    ranges = intervals((median, spread), renders, captures, seed)
    return Shift(median, spread, quantiles, *ranges)


def shift_of(values: Levels, seed: int = 0) -> Shift:
    """Return the Shift of values that were found scene by scene; at least two."""
    quantiles = empirical_quantiles(values.all)
    median = dict(quantiles)[0.5]
    none = np.zeros(2)
    spread = fitted(none, values)[1]
    ranges = intervals((median, spread), none, values, seed)
    return Shift(median, spread, quantiles, *ranges)


def fitted(renders: Array, captures: Levels) -> tuple[float, float]:
    """Return (median, spread) of the highest likelihood."""
    scenes, width = shrunk(renders)
    frequency = np.fft.rfftfreq(POINTS, STEP)
    variance = SPREADS**2 + width**2 + STEP**2 / 12
    kernel = np.exp(-2 * (np.pi * frequency) ** 2 * variance[:, None])
    transform = np.fft.rfft(counts(scenes) / len(scenes))
    density = np.fft.irfft(transform * kernel, POINTS)
    density = (1 - OUTLIERS) * np.maximum(density, 0) + OUTLIERS / POINTS
    below = np.cumsum(density, axis=1)
    total = np.zeros(density.shape)
    for levels, chance in (
        (captures.known, density),
        (captures.below, np.minimum(below, 1)),
        (captures.above, np.maximum(1 - below, OUTLIERS / POINTS)),
    ):
        if len(levels):
            logs = np.fft.rfft(np.log(chance)).conj()
            total += np.fft.irfft(np.fft.rfft(counts(levels)) * logs, POINTS)
    row, column = np.unravel_index(np.argmax(total), total.shape)
    at = np.arange(column - 1, column + 2)
    lag = (column + POINTS // 2) % POINTS - POINTS // 2
    median = STEP * (lag + top(np.array([-1.0, 0, 1]), total[row, at % POINTS]))
    near = slice(max(row - 1, 0), row + 2)
    if row == 0 or row == len(SPREADS) - 1:
        return median, float(SPREADS[row])
    return median, top(SPREADS[near], total[near, column])


def shrunk(levels: Array) -> tuple[Array, float]:
    """Return (levels nearer to their mean, standard deviation of a normal kernel) such
    that the density of both has the levels' variance."""
    sd = float(levels.std())
    quarter, three = np.percentile(levels, (25, 75))
    narrow = min(sd, float(three - quarter) / 1.349 or sd)
    width = KERNEL * narrow * len(levels) ** -0.2
    mean = levels.mean()
    scale = math.sqrt(1 - (width / sd) ** 2) if sd > 0 else 1.0
    return mean + (levels - mean) * scale, width


def counts(levels: Array) -> Array:
    """Return how many levels lie at each grid point; two share one between them."""
    place = (levels - FIRST) / STEP
    first = np.floor(place).astype(int)
    rest = place - first
    found = np.zeros(POINTS)
    np.add.at(found, first % POINTS, 1 - rest)
    np.add.at(found, (first + 1) % POINTS, rest)
    return found


def top(x: Array, y: Array) -> float:
    """Return where the parabola through three points has its top, of which the one in
    the middle is the highest."""
    left, right = x[1] - x[0], x[1] - x[2]
    down, up = y[1] - y[2], y[1] - y[0]
    curve = left * down - right * up
    if curve <= 0:
        return float(x[1])
    return float(x[1] - (left**2 * down - right**2 * up) / (2 * curve))


def normal_quantiles(median: float, spread: float) -> tuple[tuple[float, float], ...]:
    """Return quantiles of a normal distribution, of which the ends are cut."""
    z = ndtri(np.clip(PROBABILITIES, ENDS, 1 - ENDS))
    return tuple(
        (round(float(p), 3), median + spread * float(q))
        for p, q in zip(PROBABILITIES, z, strict=True)
    )


def empirical_quantiles(values: Array) -> tuple[tuple[float, float], ...]:
    """Return the quantiles of what was found frame by frame."""
    found = np.quantile(values, PROBABILITIES)
    return tuple(
        (round(float(p), 3), float(q))
        for p, q in zip(PROBABILITIES, found, strict=True)
    )


def intervals(
    found: tuple[float, float], renders: Array, captures: Levels, seed: int
) -> tuple[Range, Range]:
    """Return the intervals of (median, spread): those of the bootstrap, and where they
    are narrower, as of few frames, those of normal levels.

    Source of the spread's: Zou, Huang and Zhang, Computational Statistics and Data
    Analysis 53, 2009 (a difference of two variances); of degrees of freedom by
    kurtosis: Shoemaker, The American Statistician 57, 2003."""
    rng = np.random.default_rng(seed)
    draws = [
        fitted(rng.choice(renders, len(renders)), captures.drawn(rng))
        for _ in range(DRAWS)
    ]
    tails = 50 * (1 - LEVEL), 50 * (1 + LEVEL)
    low, high = np.percentile(draws, tails, axis=0)
    both = captures.all, renders
    (ours, ours_low, ours_high), (theirs, theirs_low, theirs_high) = map(variance, both)
    shares = np.array([ours / len(both[0]), theirs / len(both[1])])
    lengths = np.array([len(levels) for levels in both])
    freedom = shares.sum() ** 2 / max(np.sum(shares**2 / (lengths - 1)), 1e-30)
    half = float(t.ppf((1 + LEVEL) / 2, max(freedom, 1))) * math.sqrt(shares.sum())
    least = ours - theirs - math.hypot(ours - ours_low, theirs_high - theirs)
    most = ours - theirs + math.hypot(ours_high - ours, theirs - theirs_low)
    roots = math.sqrt(max(least, 0)), math.sqrt(max(most, 0))
    median, spread = found
    return (
        (min(float(low[0]), median - half), max(float(high[0]), median + half)),
        (min(float(low[1]), roots[0], spread), max(float(high[1]), roots[1], spread)),
    )


def variance(levels: Array) -> tuple[float, float, float]:
    """Return (variance, its interval's ends)."""
    count, square = len(levels), float(levels.var(ddof=1))
    if square == 0:
        return 0.0, 0.0, 0.0
    kurtosis = float(np.mean((levels - levels.mean()) ** 4)) / float(levels.var()) ** 2
    freedom = min(2 * count / max(kurtosis - (count - 3) / count, 0.5), count - 1)
    tails = (1 + LEVEL) / 2, (1 - LEVEL) / 2
    low, high = (square * freedom / float(chi2.ppf(tail, freedom)) for tail in tails)
    return square, low, high

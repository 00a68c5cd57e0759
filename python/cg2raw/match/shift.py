# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The distribution of shifts that makes one set of levels another.

Levels of frames, in stops, differ by their scenes and by their exposures: c = r + e.
The scenes of both sets are draws from one population, and exposures do not depend on
them, so the density of c is that of r convolved with that of e. e has any shape: the
one of highest likelihood of the captures' levels, which may be bounds: a frame of which
more than half is white lies above one. A normal e takes what differs between the scenes
of both for spread, and its middle follows. r is a kernel density of the renders' levels
with their variance (Silverman, Density Estimation, 1986, 6.4.1). Levels are counted on
a grid, so that time and memory do not depend on their number."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri
from scipy.stats import chi2, t

Array = NDArray[np.float64]
Range = tuple[float, float]

STEP = 1 / 16  # stops between grid points
POINTS = 1024  # of the grid
FIRST = -40.0  # stops
MOST_SHIFT = 256  # grid points, up or down
SHIFTS = STEP * np.arange(-MOST_SHIFT, MOST_SHIFT + 1)
ROUNDS = 50  # of the EM algorithm
SMOOTH = np.array([0.1, 0.8, 0.1])  # after each round, else it ends in a few spikes
OUTLIERS = 0.01  # share of frames whose level tells nothing, as a covered lens
KERNEL = 0.2  # of its width by the rule of thumb for normal levels, 0.9: modes stay
DRAWS = 200  # of the bootstrap
LEVEL = 0.99  # of intervals
PROBABILITIES = np.linspace(0, 1, 21)
MIDDLES = (np.arange(200) + 0.5) / 200  # probabilities, all of one share
TAIL = 0.1  # of a distribution, at least, that is taken to be normal
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
    found = stops_at(PROBABILITIES, renders, captures)
    quantiles = tuple(
        (round(float(p), 3), float(q))
        for p, q in zip(PROBABILITIES, found, strict=True)
    )
    ranges = intervals((median, spread), renders, captures, seed)
    return Shift(median, spread, quantiles, *ranges)


def shift_of(values: Levels, seed: int = 0) -> Shift:
    """Return the Shift of values that were found scene by scene; at least two."""
    median, spread = of_pairs(np.zeros(2), values)
    ranges = intervals((median, spread), np.zeros(2), values, seed, of_pairs)
    return Shift(median, spread, empirical_quantiles(values.all), *ranges)


def of_pairs(_: Array, values: Levels) -> tuple[float, float]:
    """Return (median, standard deviation) of values themselves."""
    return float(np.median(values.all)), float(values.all.std())


def fitted(renders: Array, captures: Levels) -> tuple[float, float]:
    """Return (median, standard deviation) of the shift of highest likelihood."""
    stops = stops_at(np.append(MIDDLES, 0.5), renders, captures)
    return float(stops[-1]), float(stops[:-1].std())


def stops_at(probabilities: Array, renders: Array, captures: Levels) -> Array:
    """Return quantiles of the shift of highest likelihood.

    Tails that few frames, or bounds alone, tell of are those of the normal distribution
    that is as wide between them."""
    share = shares(renders, captures)
    ends = np.append(0.0, np.cumsum(share))
    edges = np.append(SHIFTS, SHIFTS[-1] + STEP) - STEP / 2
    bounds = max(len(captures.above), len(captures.below)) / len(captures)
    tail = min(max(TAIL, bounds + 0.02), 0.4)
    inner = np.clip(probabilities, tail, 1 - tail)
    low, high = np.interp((tail, 1 - tail), ends / ends[-1], edges)
    deviation = (high - low) / (-2 * ndtri(tail))
    outer = np.clip(probabilities, ENDS, 1 - ENDS)
    found: Array = np.interp(inner, ends / ends[-1], edges)
    return np.asarray(found + deviation * (ndtri(outer) - ndtri(inner)))


def shares(renders: Array, captures: Levels) -> Array:
    """Return the share that each of SHIFTS has where the likelihood is highest.

    Source: Laird, Journal of the American Statistical Association 73, 1978."""
    density = density_of(renders)
    below = np.cumsum(density) - density / 2
    rows, numbers = [], []
    for levels, chance in (
        (captures.known, density),
        (captures.below, below),
        (captures.above, 1 - below),
    ):
        found = counts(levels)
        cells = np.flatnonzero(found)
        shifted = cells[:, None] - np.arange(-MOST_SHIFT, MOST_SHIFT + 1)
        rows.append(chance[np.clip(shifted, 0, POINTS - 1)])
        numbers.append(found[cells])
    number = np.concatenate(numbers)
    chance = (1 - OUTLIERS) * np.concatenate(rows) + OUTLIERS / POINTS
    share = np.full(len(SHIFTS), 1 / len(SHIFTS))
    for _ in range(ROUNDS):
        part = chance * share
        part *= (number / part.sum(axis=1))[:, None]
        share = np.convolve(part.sum(axis=0), SMOOTH, "same")
        share /= share.sum()
    return share


def density_of(levels: Array) -> Array:
    """Return the kernel density of levels, the share that each grid point has."""
    scenes, width = shrunk(levels)
    deviation = math.hypot(width, STEP / 2) / STEP
    reach = math.ceil(5 * deviation)
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / deviation) ** 2)
    found = np.convolve(counts(scenes), kernel / kernel.sum(), "same")
    return np.asarray(found / found.sum())


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
    np.add.at(found, np.clip(first, 0, POINTS - 1), 1 - rest)
    np.add.at(found, np.clip(first + 1, 0, POINTS - 1), rest)
    return found


def empirical_quantiles(values: Array) -> tuple[tuple[float, float], ...]:
    """Return the quantiles of what was found frame by frame."""
    found = np.quantile(values, PROBABILITIES)
    return tuple(
        (round(float(p), 3), float(q))
        for p, q in zip(PROBABILITIES, found, strict=True)
    )


def intervals(
    found: tuple[float, float],
    renders: Array,
    captures: Levels,
    seed: int,
    estimate: Callable[[Array, Levels], tuple[float, float]] = fitted,
) -> tuple[Range, Range]:
    """Return the intervals of (median, spread): those of the bootstrap, and where they
    are narrower, as of few frames, those of normal levels.

    Source of the spread's: Zou, Huang and Zhang, Computational Statistics and Data
    Analysis 53, 2009 (a difference of two variances); of degrees of freedom by
    kurtosis: Shoemaker, The American Statistician 57, 2003."""
    rng = np.random.default_rng(seed)
    draws = [
        estimate(rng.choice(renders, len(renders)), captures.drawn(rng))
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

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The distribution of shifts that makes one set of levels another.

Levels of frames, in stops, differ by their scenes and by their exposures: c = r + e.
The scenes of both sets are draws from one population, and exposures do not depend on
them, so the density of c is that of r convolved with that of e. e is normal, unless the
captures' levels tell otherwise: then it has any shape, as a normal e would take what
differs between the scenes of both for spread. Either is the one of highest likelihood
of those levels, which may be bounds: a frame of which more than half is white lies
above one. r is a kernel density of the renders' levels with their variance (Silverman,
Density Estimation, 1986, 6.4.1). Levels are counted on a grid, so that time and memory
do not depend on their number."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import chdtri, ndtr, ndtri, stdtrit

Array = NDArray[np.float64]
Range = tuple[float, float]

STEP = 1 / 16  # stops between grid points
POINTS = 1024  # of the grid
FIRST = -40.0  # stops
MOST_SHIFT = 256  # grid points, up or down
EDGES = STEP * (np.arange(-MOST_SHIFT, MOST_SHIFT + 2) - 0.5)  # of the shifts' cells
ROUNDS = 50  # of the EM algorithm
SMOOTH = np.array([0.1, 0.8, 0.1])  # after each round, else it ends in a few spikes
OUTLIERS = 0.01  # share of frames whose level tells nothing, as a covered lens
KERNEL = 0.2  # of its width by the rule of thumb for normal levels, 0.9: modes stay
DRAWS = 200  # of the bootstrap
LEVEL = 0.99  # of intervals, and of the test of a normal shift
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

    def bounded(self, levels: Array) -> "Levels":
        """Return other levels, of which as many of the lowest and of the highest are
        but bounds."""
        known = np.sort(levels)[len(self.below) : len(levels) - len(self.above)]
        return Levels(
            known,
            np.full(len(self.above), known[-1]),
            np.full(len(self.below), known[0]),
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


@dataclass(frozen=True)
class Fit:
    """A distribution of shifts: its quantiles, and how likely it makes captures.

    stops : quantiles at probabilities, stops. likelihood : natural logarithm."""

    median: float
    spread: float
    stops: Callable[[Array], Array]
    likelihood: float

    @property
    def both(self) -> tuple[float, float]:
        """Median and standard deviation."""
        return self.median, self.spread


def shift_between(renders: Array, captures: Levels, seed: int = 0) -> Shift:
    """Return the Shift that makes renders' levels those of captures, whose scenes are
    other draws of one population; at least two of each."""
    shape = shape_of(renders, captures, seed)
    found = shape(renders, captures)
    quantiles = tuple(
        (round(float(p), 3), float(q))
        for p, q in zip(PROBABILITIES, found.stops(PROBABILITIES), strict=True)
    )

    def estimate(ours: Array, theirs: Levels) -> tuple[float, float]:
        return shape(ours, theirs).both

    ranges = intervals(found.both, renders, captures, seed, estimate)
    return Shift(found.median, found.spread, quantiles, *ranges)


def shift_of(values: Levels) -> Shift:
    """Return the Shift of values that were found scene by scene; at least two."""
    median, spread = of_pairs(np.zeros(2), values)
    ranges = intervals((median, spread), np.zeros(2), values, 0, of_pairs)
    return Shift(median, spread, empirical_quantiles(values.all), *ranges)


def of_pairs(_: Array, values: Levels) -> tuple[float, float]:
    """Return (median, standard deviation) of values themselves."""
    return float(np.median(values.all)), float(values.all.std())


def shape_of(
    renders: Array, captures: Levels, seed: int
) -> Callable[[Array, Levels], Fit]:
    """Return normal, or any_shape where a test of the likelihoods' ratio rejects it.

    What the ratio may be by chance is drawn from the normal fit, until more draws than
    1 - LEVEL of all exceed that of the captures. Source of the latter: Besag and
    Clifford, Biometrika 78, 1991."""
    rng = np.random.default_rng(seed)
    fit = normal(renders, captures)
    gain = any_shape(renders, captures).likelihood - fit.likelihood
    scenes, width = shrunk(renders)
    exceeded = 0
    for _ in range(DRAWS - 1):
        ours, theirs = (
            rng.choice(scenes, count) + width * rng.normal(size=count)
            for count in (len(renders), len(captures))
        )
        theirs += fit.median + fit.spread * rng.normal(size=len(theirs))
        drawn = captures.bounded(theirs)
        other = any_shape(ours, drawn).likelihood - normal(ours, drawn).likelihood
        exceeded += other >= gain
        if exceeded + 1 > (1 - LEVEL) * DRAWS:
            return normal
    return any_shape


def normal(renders: Array, captures: Levels) -> Fit:
    """Return the normal Fit of highest likelihood."""
    chance, number = chances(renders, captures)

    def of(values: Array) -> tuple[float, float]:
        return float(values[0]), math.hypot(float(values[1]), STEP / 2)

    def likelihood(values: Array) -> float:
        median, spread = of(values)
        share = np.diff(ndtr((EDGES - median) / spread))
        return float(number @ np.log(chance @ share))

    square = float(captures.all.var() - renders.var())
    start = np.median(captures.all) - np.median(renders), max(square, STEP) ** 0.5
    best = minimize(
        lambda values: -likelihood(values),
        np.array(start),
        method="Nelder-Mead",
        options={"xatol": STEP / 32, "fatol": 1e-3},
    )
    median, spread = of(best.x)

    def stops(probabilities: Array) -> Array:
        outer = np.clip(probabilities, ENDS, 1 - ENDS)
        return np.asarray(median + spread * ndtri(outer))

    return Fit(median, spread, stops, -float(best.fun))


def any_shape(renders: Array, captures: Levels) -> Fit:
    """Return the Fit of highest likelihood.

    Tails that few frames, or bounds alone, tell of are those of the normal distribution
    that is as wide between them. Source: Laird, Journal of the American Statistical
    Association 73, 1978."""
    chance, number = chances(renders, captures)
    share = np.full(chance.shape[1], 1 / chance.shape[1])
    for _ in range(ROUNDS):
        part = chance * share
        part *= (number / part.sum(axis=1))[:, None]
        share = np.convolve(part.sum(axis=0), SMOOTH, "same")
        share /= share.sum()
    ends = np.append(0.0, np.cumsum(share))
    bounds = max(len(captures.above), len(captures.below)) / len(captures)
    tail = min(max(TAIL, bounds + 0.02), 0.4)
    low, high = np.interp((tail, 1 - tail), ends / ends[-1], EDGES)
    deviation = (high - low) / (-2 * ndtri(tail))

    def stops(probabilities: Array) -> Array:
        inner = np.clip(probabilities, tail, 1 - tail)
        outer = np.clip(probabilities, ENDS, 1 - ENDS)
        found: Array = np.interp(inner, ends / ends[-1], EDGES)
        return np.asarray(found + deviation * (ndtri(outer) - ndtri(inner)))

    return Fit(
        float(stops(np.array(0.5))),
        float(stops(MIDDLES).std()),
        stops,
        float(number @ np.log(chance @ share)),
    )


def chances(renders: Array, captures: Levels) -> tuple[Array, Array]:
    """Return (cells, shifts): how likely each shift makes a capture of each cell of the
    grid in which there is one; and how many there are (cells,)."""
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
    chance = (1 - OUTLIERS) * np.concatenate(rows) + OUTLIERS / POINTS
    return chance, np.concatenate(numbers)


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
    estimate: Callable[[Array, Levels], tuple[float, float]],
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
    half = float(stdtrit(max(freedom, 1), (1 + LEVEL) / 2)) * math.sqrt(shares.sum())
    least = ours - theirs - math.hypot(ours - ours_low, theirs_high - theirs)
    most = ours - theirs + math.hypot(ours_high - ours, theirs - theirs_low)
    roots = math.sqrt(max(least, 0)), math.sqrt(max(most, 0))
    median, spread = found
    return (
        (min(float(low[0]), median - half), max(float(high[0]), median + half)),
        (min(float(low[1]), roots[0], spread), max(float(high[1]), roots[1], spread)),
    )


def variance(levels: Array) -> tuple[float, float, float]:
    """Return (variance, its interval's ends), by chi-square of as many degrees of
    freedom as give it the variance that it has with the kurtosis of the levels, and no
    more than normal levels have. Source: A. M. Mood et al., Introduction to the Theory
    of Statistics, section VI.2: (kurtosis - (n - 3) / (n - 1)) / n of its square."""
    count, square = len(levels), float(levels.var(ddof=1))
    if square == 0:
        return 0.0, 0.0, 0.0
    kurtosis = float(np.mean((levels - levels.mean()) ** 4)) / float(levels.var()) ** 2
    freedom = min(
        2 * count / max(kurtosis - (count - 3) / max(count - 1, 1), 0.5), count - 1
    )
    tails = (1 + LEVEL) / 2, (1 - LEVEL) / 2
    low, high = (square * freedom / float(chdtri(freedom, 1 - tail)) for tail in tails)
    return square, low, high

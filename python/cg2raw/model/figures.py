# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The figures of a sensor by one fit of its darks and flats, with 95 % intervals.

Patterns are of what is not masked, and leave out polynomials (statistics.constant):
those up to degree SLOW down and across are structure (of the bias, of the shading).
A PRNU that is measured above a higher frequency, as EMVA 1288 has it, is smaller where
the response also varies from ten pixels to a hundred."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import gammaincinv, stdtrit

from cg2raw.model.fit import Fit
from cg2raw.model.levels import Line
from cg2raw.model.planes import PlaneLikelihood, neighbours
from cg2raw.model.structure import structure_of
from cg2raw.normal import CI95
from cg2raw.statistics.constant import Array, ConstantStatistics

# Of a dark's samples at 0: with more, not even the median of its signal is seen, and
# what darks say rests on the tail of a law.
MOST_CUT = 0.5


@dataclass(frozen=True)
class Figure:
    """A named value. low, high : its 95 % interval. site : the plane whose it is, in
    raster order of the CFA's repeat; None if it is of all. freedom : of chi-square, of
    one whose interval is by that."""

    name: str
    unit: str
    value: float
    standard_error: float
    low: float
    high: float
    site: int | None = None
    freedom: float = np.inf

    @classmethod
    def normal(
        cls, name: str, unit: str, value: float, error: float, least: float = -np.inf
    ) -> "Figure":
        """Return one with the interval of a normal law, cut at the least that it may
        be."""
        half = CI95 * error
        return cls(name, unit, value, error, max(value - half, least), value + half)


def figures_of(
    statistics: ConstantStatistics, found: Fit, most_cut: float = MOST_CUT
) -> list[Figure]:
    """Return what the frames show, in the order of the physics; what they do not show
    is missing, and all of darks where more than most_cut of one is at 0."""
    all_of_them = [*_light(found)]
    darks = ~statistics.is_flat
    if not any((plane.low[darks] > most_cut).any() for plane in statistics.planes):
        all_of_them = [
            *_levels(statistics, found),
            *_noise(found),
            *_correlations(statistics, found),
            *_patterns(found),
            *all_of_them,
        ]
    return [figure for figure in all_of_them if np.isfinite(figure.standard_error)]


def _levels(statistics: ConstantStatistics, found: Fit) -> Iterator[Figure]:
    line = found.likelihood.levels.line(found.theta)
    if line is None:
        return
    for site in range(found.parameters.sites):
        value, error = found.of("black_level", site)
        yield _by_student("black level", "DN", value, error, line, site)
    yield _drift(statistics, found)
    value, error = found.of("dark_current")
    yield _by_student("dark current", "DN/s", value, error, line)


def _by_student(
    name: str,
    unit: str,
    value: float,
    error: float,
    line: Line,
    site: int | None = None,
) -> Figure:
    """Return a figure of the levels. Few frames tell their drift, so the interval is
    Student's; and it is wider where the line misses the levels."""
    error = error * line.misfit
    half = float(stdtrit(line.freedom, 0.975)) * error if line.freedom > 0 else np.inf
    return Figure(name, unit, value, error, value - half, value + half, site)


def _drift(statistics: ConstantStatistics, found: Fit) -> Figure:
    """Return the sd of the level of darks that repeat each other, less what noise moves
    it; its interval is that of chi-square. If each split has one group of them of an
    exposure time, all of these repeat each other."""
    planes = found.likelihood.planes
    total = freedom = floor = 0.0
    for darks in statistics.darks_by_time():
        splits = {statistics.groups[g].split for g in darks}
        for some in [darks] if len(splits) == len(darks) else darks[:, None]:
            each = [np.concatenate([p.plane.levels[g] for g in some]) for p in planes]
            levels = np.mean(each, axis=0)
            records = [plane.records(found.theta).values for plane in planes]
            response = float(np.mean([one.fixed[some] for one in records]))
            again = len(levels) - 1
            total += float(levels.var(ddof=1)) * again / response**2
            noise = float(found.likelihood.levels.noise[0][some].mean())
            floor += again * noise / response**2
            freedom += again
    if not freedom:
        return Figure("black level drift", "DN", np.nan, np.nan, np.nan, np.nan)
    total, floor = total / freedom, floor / freedom
    # By the quantiles of chi-square.
    ends = total * freedom / (2 * gammaincinv(freedom / 2, [0.975, 0.025]))
    error = total * np.sqrt(2 / freedom)
    around = ends[0] - floor, ends[1] - floor
    root = _root("black level drift", "DN", total - floor, error, around)
    return replace(root, freedom=freedom)


def _root(
    name: str,
    unit: str,
    square: float,
    error: float,
    ends: tuple[float, float] | None = None,
    site: int | None = None,
) -> Figure:
    """Return the root of a variance with its error and interval; 0 for one below 0.
    It is missing where all of its interval is below 0."""
    low, high = ends or (square - CI95 * error, square + CI95 * error)
    if high <= 0:  # no variance: the model is not that of these frames
        error = np.nan
    low, value, high = (float(np.sqrt(max(x, 0.0))) for x in (low, square, high))
    # The root of a variance near 0 has no slope: there the error is half the interval.
    by_slope = error / 2 / value if value > 0 else np.inf + error
    error = np.minimum(by_slope, (high - low) / 2 / CI95)
    return Figure(name, unit, value, error, low, high, site)


def _noise(found: Fit) -> Iterator[Figure]:
    for site, plane in enumerate(found.likelihood.planes):
        read, error = found.of("read_noise", site)
        yield _root("read noise", "DN", read, error, site=site)
        shortest = int(np.argmin(np.where(plane.is_flat, np.inf, plane.time)))
        records, slopes = plane.records(found.theta)
        of_lines = [found.parameters.of(n) for n in ("row_noise", "column_noise")]
        slope = slopes.variance[shortest]
        slope[of_lines] += 1.0
        yield _root(
            "temporal dark noise",
            "DN",
            float(records.variance[shortest] + found.theta[of_lines].sum()),
            float(np.sqrt(found.variance_of(slope))),
            site=site,
        )
    yield _root("row noise", "DN", *found.of("row_noise"))
    yield _root("column noise", "DN", *found.of("column_noise"))


def _correlations(statistics: ConstantStatistics, found: Fit) -> Iterator[Figure]:
    """Yield the correlation of a dark's noise with its next neighbours, of the shortest
    darks that repeat each other."""
    used = statistics.shortest_darks()
    if not len(used):
        return
    pairs = statistics.pairs[used].astype(float)
    for name, lag in (
        ("correlation, next in row", (0, 1)),
        ("correlation, next in column", (1, 0)),
    ):
        measured = neighbours(statistics, *lag)
        if measured is None:
            continue
        each = [_unrecorded(found, p, lag, measured) for p in found.likelihood.planes]
        values, slopes, coded = (
            np.mean(some, axis=0)[used] for some in zip(*each, strict=True)
        )
        value = float(np.average(values, weights=pairs))
        slope = np.average(slopes, axis=0, weights=pairs)
        own = 1 / (pairs.sum() * statistics.unmasked) / coded.mean() ** 2
        error = float(np.sqrt(own + found.variance_of(slope)))
        yield Figure.normal(name, "1", value, error)


def _unrecorded(
    found: Fit, plane: PlaneLikelihood, lag: tuple[int, int], measured: Array
) -> tuple[Array, Array, Array]:
    """Return (G,) correlations of the noise that codes with @measured ones record,
    (G, n) their slopes by parameters, and (G,) what one of 1 is recorded as.

    The offset of a line moves neighbours in it more, or less, than all of it on
    average: that is not of their noise."""
    (noise, *_), (by, *_) = plane.offsets(found.theta)
    at, moving = plane.records(found.theta)
    if lag == (0, 1):
        line, near, beyond = "row_noise", at.across, at.in_rows
        by_near, by_beyond = moving.across, moving.in_rows
    else:
        line, near, beyond = "column_noise", at.down, at.in_columns
        by_near, by_beyond = moving.down, moving.in_columns
    place = found.parameters.of(line)
    size = max(float(found.theta[place]), 0.0)
    coded = noise * near**2
    values = (measured * at.variance - size * beyond) / coded
    slopes = measured[:, None] * moving.variance - size * by_beyond
    slopes[:, place] -= beyond
    by_coded = by * near[:, None] ** 2 + 2 * (noise * near)[:, None] * by_near
    slopes -= values[:, None] * by_coded
    return values, slopes / coded[:, None], coded / at.variance


def _patterns(found: Fit) -> Iterator[Figure]:
    yield _root("DSNU", "DN", *found.of("dsnu"))
    yield _root("fixed column pattern", "DN", *found.of("column_fixed_pattern"))
    yield _root("fixed row pattern", "DN", *found.of("row_fixed_pattern"))
    yield _root("bias structure", "DN", *structure_of(found, "constant"))
    uneven = found.of("dark_current_nonuniformity")
    yield _root("dark current nonuniformity", "DN/s", *uneven)
    yield _root("glow", "DN/s", *structure_of(found, "time"))


def _light(found: Fit) -> Iterator[Figure]:
    for site in range(found.parameters.sites):
        value, error = found.of("gain", site)
        ends = _inverse(value + CI95 * error), _inverse(value - CI95 * error)
        relative = error / value if value > 0 else np.nan
        yield Figure(
            "gain", "e-/DN", _inverse(value), relative * _inverse(value), *ends, site
        )
    yield _root("PRNU", "1", *found.of("prnu"))
    yield _root("shading", "1", *structure_of(found, "light"))


def _inverse(value: float) -> float:
    return 1 / value if value > 0 else np.inf

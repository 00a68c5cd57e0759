# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Black: the level without light or charge, its drift, and its fixed structure.

Source: EMVA Standard 1288, release 4.0, sections on dark signal and DSNU (spatial
variances split into columns, rows and pixels).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cg2raw.calibration.decay import fit_decay
from cg2raw.calibration.frames import Group
from cg2raw.calibration.measured import SIGNIFICANT, Measured, root_of
from cg2raw.calibration.robust import (
    CUT,
    LEAST_SIGMA,
    Array,
    clipped_moments,
    line_means,
)
from cg2raw.calibration.sites import Sites

EDGE_LENGTHS = np.geomspace(0.7, 256, 40)  # px that are tried
LONGEST_EDGE = 1 / 6  # of the width; a longer one is the ramp's
LEAST_COLUMNS = 32  # for an edge beside a ramp
FIRST_COLUMNS = 8  # that count for it however far off they are


@dataclass(frozen=True)
class BiasStructure:
    """Fixed offsets, DN. horizontal, vertical : of the right edge over the left, the
    bottom over the top, of a straight ramp. edge : of column 0, falling to its e-th
    part in edge_length px; both None where the first columns are like the others.
    columns, rows : the profiles, DN, mean 0."""

    horizontal: Measured
    vertical: Measured
    edge: Measured | None
    edge_length: Measured | None
    columns: Array
    rows: Array
    fitted_columns: Array
    fitted_rows: Array

    @property
    def edge_is_longer(self) -> bool:
        """Whether the edge is as long as any that is tried: it may be longer."""
        if self.edge_length is None:
            return False
        return self.edge_length.value >= float(edge_lengths(len(self.columns))[-1])

    @property
    def edge_columns(self) -> Array:
        """The edge alone, DN of each column."""
        if self.edge is None or self.edge_length is None:
            return np.zeros(len(self.columns))
        place = np.arange(len(self.columns))
        found: Array = self.edge.value * np.exp(-place / self.edge_length.value)
        return found


def black_levels(
    offset: Array, known: Array, sites: Sites, structure: BiasStructure, drift: float
) -> tuple[Measured, ...]:
    """Return the mean of each site's offsets, DN; its structure is about that mean.

    drift : DN, by which the mean of the frames may be off."""
    shares = (
        rest_of(structure.columns, structure.fitted_columns) * sites.side**0.5,
        rest_of(structure.rows, structure.fitted_rows) * sites.side**0.5,
        drift,
    )
    found = []
    level = (structure.columns[None] + structure.rows[:, None]).astype(np.float32)
    for plane, used in zip(sites.of(offset - level), sites.of(known), strict=True):
        mean, sigma, count = clipped_moments(plane[used], LEAST_SIGMA * sites.step)
        error = math.hypot(*shares, sigma / math.sqrt(count))
        found.append(Measured(mean, error, "DN"))
    return tuple(found)


def bias_structure(
    offset: Array,
    known: Array,
    sites: Sites,
) -> BiasStructure:
    """Return the structure of an (H, W) map of offsets, DN."""
    flat = np.array(offset, np.float32)
    for plane, used in zip(sites.of(flat), sites.of(known), strict=True):
        plane -= np.float32(np.median(plane[used]))
    flat[~known] = 0
    columns, rows = _lines(flat, known, sites)
    columns -= columns.mean()
    rows -= rows.mean()
    horizontal, edge, length, of_columns = ramp_and_edge(columns)
    vertical, _, _, of_rows = ramp_and_edge(rows, with_edge=False)
    return BiasStructure(
        horizontal,
        vertical,
        edge,
        length,
        columns,
        rows,
        of_columns,
        of_rows,
    )


def rest_of(profile: Array, fitted: Array) -> float:
    """Return by how much lines beyond a fit may move the mean of them all, DN."""
    return float(clipped_moments(profile - fitted)[1]) / math.sqrt(len(profile))


def _lines(flat: Array, known: Array, sites: Sites) -> tuple[Array, Array]:
    """Return (columns, rows): means without pixels 4 sigma off their own column and
    row. They are taken off @flat, in place.

    Medians of some pixels come first: a column may be far off the others."""
    steps = [max(1, side // 128) | 1 for side in flat.shape]  # odd: of all sites
    columns = np.median(flat[:: steps[0]], axis=0)
    flat -= columns[None]
    rows = np.median(flat[:, :: steps[1]], axis=1)
    flat -= rows[:, None]
    pairs = zip(sites.of(flat), sites.of(known), strict=True)
    least = LEAST_SIGMA * sites.step
    sigmas = [max(clipped_moments(p[used], least)[1], least) for p, used in pairs]
    inside = known & (np.abs(flat) <= CUT * sites.spread(sigmas, flat.shape))
    more, _, filled = line_means(flat, inside, 0)
    flat -= more[None].astype(np.float32)
    columns = over_gaps(columns.astype(np.float64) + more, filled)
    more, _, filled = line_means(flat, inside, 1)
    flat -= more[:, None].astype(np.float32)
    rows = over_gaps(rows.astype(np.float64) + more, filled)
    return columns, rows


def over_gaps(lines: Array, filled: Array) -> Array:
    """Return means of lines, straight between their neighbours where none is known."""
    place = np.arange(len(lines))
    found: Array = np.interp(place, place[filled], lines[filled])
    return found


def ramp_and_edge(
    profile: Array, with_edge: bool = True
) -> tuple[Measured, Measured | None, Measured | None, Array]:
    """Return (ramp, edge, its length, the fitted profile), DN and px.

    profile : (N,) DN. The ramp is end over beginning, 0 in the middle; the edge falls
    by a factor e over its length. Columns far off the others do not count."""
    column = np.arange(len(profile))
    place = (column + 0.5) / len(profile) - 0.5
    straight = np.stack([np.ones_like(place), place], 1)
    if with_edge and len(profile) >= LEAST_COLUMNS:
        lengths = edge_lengths(len(profile))
        found = fit_decay(straight, column, profile, lengths, first=FIRST_COLUMNS)
        wide = math.sqrt(_correlated(found.rest))
        ramp, edge = (
            Measured(float(found.values[i]), float(found.errors[i]) * wide, "DN")
            for i in (1, 2)
        )
        if edge.stands_out and abs(edge.value) > CUT * math.sqrt(found.variance):
            length = Measured(found.length, float(found.errors[3]) * wide, "px")
            return ramp, edge, length, profile - found.rest
    line = _fit(straight, profile)
    return _error_of(line, 1), None, None, straight @ line[0]


def edge_lengths(width: int) -> Array:
    """Return the lengths of an edge, px, that are tried."""
    found: Array = EDGE_LENGTHS[EDGE_LENGTHS < width * LONGEST_EDGE]
    return found


Fit = tuple[Array, Array, float]  # values, inverse normal matrix, variance


def _fit(design: Array, y: Array) -> Fit:
    """Return least squares without what lies 4 sigma off."""
    keep = np.ones(len(y), bool)
    for _ in range(4):
        values = np.linalg.lstsq(design[keep], y[keep], rcond=None)[0]
        rest = y - design @ values
        freedom = max(int(keep.sum()) - design.shape[1], 1)
        variance = float((rest[keep] ** 2).sum()) / freedom
        keep = np.abs(rest) <= CUT * clipped_moments(rest)[1]
    inverse = np.linalg.pinv(design[keep].T @ design[keep])
    return values, inverse * _correlated(rest[keep]), variance


def _correlated(rest: Array) -> float:
    """Return by how much neighbours that correlate widen a fit's variance."""
    most = CUT * clipped_moments(rest)[1]
    rest = np.clip(rest, -most, most)
    own = float(rest @ rest)
    next_one = float(rest[1:] @ rest[:-1]) / own if own > 0 else 0.0
    r = min(max(next_one, 0.0), 0.95)
    return (1 + r) / (1 - r)


def _error_of(fit: Fit, index: int) -> Measured:
    values, inverse, variance = fit
    error = math.sqrt(max(float(inverse[index, index]) * variance, 0.0))
    return Measured(float(values[index]), error, "DN")


@dataclass(frozen=True)
class Drift(Measured):
    """Standard deviation of the level from frame to frame, DN, without what noise of
    pixels, rows and columns moves it. total : DN, with it. freedom : of that."""

    total: float
    freedom: int

    @property
    def stands_out(self) -> bool:
        """Whether the level moves more than that noise moves it, at 3 sigma: by the
        distribution of chi-square (E. Wilson, M. Hilferty, PNAS 17, 1931)."""
        part = 2 / (9 * self.freedom)
        most = (1 - part + SIGNIFICANT * math.sqrt(part)) ** 3
        return self.total**2 > most * (self.total**2 - self.value**2)


def level_drift(groups: Sequence[Group], floor: float) -> Drift | None:
    """Return how the level moves from frame to frame; None if no two frames repeat each
    other.

    groups : of exposures so short that dark current does not show. floor : DN^2, the
    variance of a frame's mean by noise."""
    squares, freedom = 0.0, 0
    for group in groups:
        levels = np.array([scanned.mean_level for scanned in group.frames])
        squares += float(((levels - levels.mean()) ** 2).sum())
        freedom += len(levels) - 1
    if not freedom:
        return None
    total = squares / freedom
    own = root_of(total - floor, total * math.sqrt(2 / freedom), "DN")
    return Drift(own.value, own.standard_error, "DN", math.sqrt(total), freedom)

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Structure of what darks have: a ramp and first columns of the bias, and the glow of
an amplifier.

Decays are least squares of a straight part and an exponential of unknown length; the
errors of height and length are those of both together."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from cg2raw.calibration.measured import CUT, Array, LinearFit, Measured, linear_fit
from cg2raw.calibration.seen import Seen
from cg2raw.calibration.sites import FIELD_BLOCKS, blocks_of, centres
from cg2raw.statistics.constant import lines_of_mosaic

EDGE_LENGTHS = np.geomspace(0.7, 256, 40)  # px that are tried
LONGEST_EDGE = 1 / 6  # of the width; a longer one is the ramp's
LEAST_COLUMNS = 32  # for an edge beside a ramp
FIRST_COLUMNS = 8  # that count for it however far off they are
EXTENTS = np.geomspace(0.03, 1.0, 15)  # half diagonals of the frame
# (row, column) of an amplifier, -1..1 of the frame: corners and middles of edges.
PLACES = tuple((r, c) for r in (-1.0, 0.0, 1.0) for c in (-1.0, 0.0, 1.0) if r or c)
ROUNDS = 8
LARGEST_STEP = 0.3  # of the logarithm of a length in one round
SETTLED = 1e-6
AT_END = 0.999  # of the longest length that is tried: it may be longer
CERTAIN = 5.0  # standard errors: of the best of 120 places and extents


def fit_decay(
    straight: Array, distance: Array, y: Array, lengths: Array, first: int = 0
) -> tuple[LinearFit, float, float, Array]:
    """Return the robust least squares of straight @ a + height exp(-distance / length):
    (fit, height, length, errors of a, of the height and of the length).

    straight : (N, k). distance : (N,), and lengths to try in its unit. first : how many
    of y count however far off they are: the decay may be of them alone."""

    def fitted(length: float, *more: Array) -> LinearFit:
        fall = np.exp(-distance / length)
        design = [straight, fall, *(fall * x for x in more)]
        return linear_fit(np.column_stack(design), y, first)

    length = float(min(lengths, key=lambda x: float((fitted(x).clipped ** 2).sum())))
    for _ in range(ROUNDS):  # of Gauss and Newton, in the logarithm of the length
        found = fitted(length, distance / length)
        height, change = map(float, found.values[-2:])
        step = change / height if height else 0.0
        length *= math.exp(np.clip(step, -LARGEST_STEP, LARGEST_STEP))
        length = float(np.clip(length, lengths[0], lengths[-1]))
        if abs(step) < SETTLED:
            break
    errors = np.sqrt(np.maximum(np.diag(found.covariance), 0))
    errors[-1] *= length / max(abs(height), 1e-300)
    return found, height, length, errors


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
        longest = AT_END * float(edge_lengths(len(self.columns))[-1])
        return self.edge_length is not None and self.edge_length.value > longest

    @property
    def edge_mean(self) -> float:
        """What the edge adds to the mean of all columns, DN."""
        if self.edge is None or self.edge_length is None:
            return 0.0
        fall = np.exp(-np.arange(len(self.columns)) / self.edge_length.value)
        return self.edge.value * float(fall.mean())


def bias_structure(seen: Seen) -> BiasStructure:
    """Return the structure of the shortest darks, by means of rows and columns."""
    used, planes = seen.shortest, seen.statistics.planes
    weights = seen.statistics.frames[used] / seen.statistics.frames[used].sum()
    columns = lines_of_mosaic([weights @ p.columns[used] for p in planes], across=True)
    rows = lines_of_mosaic([weights @ p.rows[used] for p in planes], across=False)
    horizontal, edge, length, of_columns = ramp_and_edge(columns)
    vertical, _, _, of_rows = ramp_and_edge(rows, with_edge=False)
    return BiasStructure(
        horizontal, vertical, edge, length, columns, rows, of_columns, of_rows
    )


def ramp_and_edge(
    profile: Array, with_edge: bool = True
) -> tuple[Measured, Measured | None, Measured | None, Array]:
    """Return (ramp, edge, its length, the fitted profile), DN and px.

    profile : (N,) DN. The ramp is end over beginning, 0 in the middle; the edge falls
    by a factor e over its length. Columns far off the others do not count."""
    column = np.arange(len(profile))
    straight = np.stack([np.ones(len(profile)), (column + 0.5) / len(profile) - 0.5], 1)
    if with_edge and len(profile) >= LEAST_COLUMNS:
        lengths = edge_lengths(len(profile))
        fit, height, length, errors = fit_decay(
            straight, column, profile, lengths, first=FIRST_COLUMNS
        )
        _, of_ramp, of_edge, of_length = map(float, errors * correlated(fit))
        edge = Measured(height, of_edge, "DN")
        if edge.stands_out and abs(height) > CUT * math.sqrt(fit.variance):
            ramp = Measured(float(fit.values[1]), of_ramp, "DN")
            return ramp, edge, Measured(length, of_length, "px"), profile - fit.rest
    line = linear_fit(straight, profile)
    error = math.sqrt(line.covariance[1, 1]) * correlated(line)
    return Measured(float(line.values[1]), error, "DN"), None, None, profile - line.rest


def edge_lengths(width: int) -> Array:
    """Return the lengths of an edge, px, that are tried."""
    return EDGE_LENGTHS[EDGE_LENGTHS < width * LONGEST_EDGE]


def correlated(fit: LinearFit) -> float:
    """Return by how much neighbours that correlate widen a fit's errors."""
    rest = fit.clipped
    own = float(rest @ rest)
    r = float(np.clip(rest[1:] @ rest[:-1] / own, 0.0, 0.95)) if own > 0 else 0.0
    return math.sqrt((1 + r) / (1 - r))


@dataclass(frozen=True)
class Glow:
    """Charge of an amplifier's light: per_second exp(-d / extent), DN/s; d in half
    diagonals from (row, column): -1 is the top or left edge, 1 the bottom or right.
    residual : DN/s, what blocks have besides. mean : DN/s, the glow of the mean
    block. certainty : per_second over its error, were the place known."""

    per_second: Measured
    row: Measured
    column: Measured
    extent: Measured
    residual: float
    mean: float
    certainty: float

    @property
    def stands_out(self) -> bool:
        """Whether it is beyond chance, and beyond what else blocks have."""
        is_there = self.certainty > CERTAIN
        return is_there and self.per_second.value > CUT * self.residual

    @property
    def is_measured(self) -> bool:
        """Whether it stands out and is narrower than the widest that is tried: at that
        bound it may be any slope over the field."""
        return self.stands_out and self.extent.value < AT_END * EXTENTS[-1]


def glow(rate: Array) -> Glow:
    """Return the best glow in an (H, W) map of dark current, DN/s; nan is unknown.

    The best of PLACES is where least squares of the place begin."""
    across = min(FIELD_BLOCKS, *(side // 8 for side in rate.shape))
    known = [block[np.isfinite(block)] for block in blocks_of(rate, across)]
    smooth = np.array([float(np.median(b)) if b.size else 0.0 for b in known])
    half = math.hypot(*rate.shape) / 2
    places = [2 * centres(n, across) / n - 1 for n in rate.shape]
    sides = [n / 2 / half for n in rate.shape]

    def far_from(row: float, col: float) -> Array:
        rows, cols = (
            side * (place - at)
            for side, place, at in zip(sides, places, (row, col), strict=True)
        )
        return np.asarray(np.hypot(rows[:, None], cols[None]).ravel())

    def misses(x: Array) -> Array:
        base, height, row, col, extent = x
        shine = height * np.exp(-far_from(row, col) / extent)
        return np.asarray(base + shine - smooth)

    tried = []
    for row, col in PLACES:
        far = far_from(row, col)
        fit, height, length, errors = fit_decay(
            np.ones((len(far), 1)), far, smooth, EXTENTS
        )
        certainty = height / max(float(errors[1]), 1e-300)
        start = float(fit.values[0]), height, row, col, length
        tried.append((fit.variance, certainty, start))
    _, certainty, start = min([one for one in tried if one[1] > 0] or tried)
    lowest, highest = (-np.inf, -np.inf, -1, -1), (np.inf, np.inf, 1, 1)
    bounds = (*lowest, EXTENTS[0]), (*highest, EXTENTS[-1])
    found = least_squares(misses, start, bounds=bounds, x_scale="jac")
    variance = 2 * float(found.cost) / max(len(smooth) - len(start), 1)
    covariance = np.linalg.pinv(found.jac.T @ found.jac) * variance
    errors = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    _, shine, at_row, at_column, extent = (
        Measured(float(value), float(error), unit)
        for value, error, unit in zip(
            found.x, errors, ("DN/s", "DN/s", "1", "1", "1"), strict=True
        )
    )
    mean = float((misses(found.x) + smooth - found.x[0]).mean())
    residual = math.sqrt(variance)
    return Glow(shine, at_row, at_column, extent, residual, mean, certainty)

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Structure of what darks have: a ramp and first columns of the bias, and the glow of
an amplifier.

Decays are least squares of a straight part and an exponential of unknown length; the
errors of height and length are those of both together."""

import math
from dataclasses import dataclass

import numpy as np

from cg2raw.calibration.measured import Measured
from cg2raw.calibration.robust import CUT, Array, LinearFit, clipped_moments, linear_fit
from cg2raw.calibration.seen import Seen
from cg2raw.calibration.sites import FIELD_BLOCKS, blocks_of, centres

EDGE_LENGTHS = np.geomspace(0.7, 256, 40)  # px that are tried
LONGEST_EDGE = 1 / 6  # of the width; a longer one is the ramp's
LEAST_COLUMNS = 32  # for an edge beside a ramp
FIRST_COLUMNS = 8  # that count for it however far off they are
EXTENTS = np.geomspace(0.03, 1.0, 15)  # half diagonals of the frame
# (row, column) of an amplifier, -1..1 of the frame: corners and middles of edges.
PLACES = tuple((r, c) for r in (-1.0, 0.0, 1.0) for c in (-1.0, 0.0, 1.0) if r or c)
ROUNDS = 8
LARGEST_STEP = 0.3  # of the logarithm of a length in one round
AT_END = 0.999  # of the longest length that is tried: it may be longer
CERTAIN = 5.0  # standard errors: of the best of 120 places and extents


@dataclass(frozen=True)
class Decay:
    """straight : values of the straight part's columns. errors : theirs, of the height
    and of the length. rest, variance : see LinearFit."""

    straight: Array
    height: float
    length: float
    errors: Array
    rest: Array
    variance: float


def fit_decay(
    straight: Array, distance: Array, y: Array, lengths: Array, first: int = 0
) -> Decay:
    """Return the robust least squares of straight @ a + height exp(-distance / length).

    straight : (N, k). distance : (N,), and lengths to try in its unit. first : how many
    of y count however far off they are: the decay may be of them alone."""

    def fitted(length: float, *more: Array) -> LinearFit:
        fall = np.exp(-distance / length)
        return linear_fit(
            np.column_stack([straight, fall, *(fall * x for x in more)]), y, first
        )

    length = float(min(lengths, key=lambda tried: fitted(tried).squares))
    for _ in range(ROUNDS):  # of Gauss and Newton, in the logarithm of the length
        found = fitted(length, distance / length)
        *values, height, change = found.values
        step = change / height if height else 0.0
        length *= math.exp(np.clip(step, -LARGEST_STEP, LARGEST_STEP))
        length = float(np.clip(length, lengths[0], lengths[-1]))
    errors = np.sqrt(np.maximum(np.diag(found.covariance), 0))
    errors[-1] *= length / max(abs(height), 1e-300)
    return Decay(
        np.array(values), float(height), length, errors, found.rest, found.variance
    )


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
        longest = float(edge_lengths(len(self.columns))[-1])
        return self.edge_length.value > AT_END * longest

    @property
    def edge_mean(self) -> float:
        """What the edge adds to the mean of all columns, DN."""
        if self.edge is None or self.edge_length is None:
            return 0.0
        fall = np.exp(-np.arange(len(self.columns)) / self.edge_length.value)
        return self.edge.value * float(fall.mean())


def bias_structure(seen: Seen) -> BiasStructure:
    """Return the structure of the shortest darks, by means of rows and columns."""
    used, side = seen.shortest, seen.sites.side
    weights = seen.statistics.frames[used] / seen.statistics.frames[used].sum()
    height, width = seen.statistics.planes[0].shape
    columns, rows = np.zeros(side * width), np.zeros(side * height)
    for site, plane in enumerate(seen.statistics.planes):
        columns[site % side :: side] += weights @ plane.columns[used] / side
        rows[site // side :: side] += weights @ plane.rows[used] / side
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
    place = (column + 0.5) / len(profile) - 0.5
    straight = np.stack([np.ones_like(place), place], 1)
    if with_edge and len(profile) >= LEAST_COLUMNS:
        lengths = edge_lengths(len(profile))
        found = fit_decay(straight, column, profile, lengths, first=FIRST_COLUMNS)
        of_ramp, of_edge, of_length = found.errors[1:] * correlated(found.rest)
        edge = Measured(found.height, of_edge, "DN")
        if edge.stands_out and abs(edge.value) > CUT * math.sqrt(found.variance):
            ramp = Measured(float(found.straight[1]), of_ramp, "DN")
            length = Measured(found.length, of_length, "px")
            return ramp, edge, length, profile - found.rest
    line = linear_fit(straight, profile)
    error = math.sqrt(line.covariance[1, 1]) * correlated(line.rest)
    return Measured(float(line.values[1]), error, "DN"), None, None, profile - line.rest


def edge_lengths(width: int) -> Array:
    """Return the lengths of an edge, px, that are tried."""
    found: Array = EDGE_LENGTHS[EDGE_LENGTHS < width * LONGEST_EDGE]
    return found


def correlated(rest: Array) -> float:
    """Return by how much neighbours that correlate widen a fit's errors."""
    most = CUT * clipped_moments(rest)[1]
    rest = np.clip(rest, -most, most)
    own = float(rest @ rest)
    next_one = float(rest[1:] @ rest[:-1]) / own if own > 0 else 0.0
    r = min(max(next_one, 0.0), 0.95)
    return math.sqrt((1 + r) / (1 - r))


@dataclass(frozen=True)
class Glow:
    """Charge of an amplifier's light: per_second exp(-d / extent), DN/s; d in half
    diagonals from (row, column): -1 is the top or left edge, 1 the bottom or right.
    residual : DN/s, what blocks have besides. mean : DN/s, the glow of the mean
    block."""

    per_second: Measured
    row: float
    column: float
    extent: Measured
    residual: float
    mean: float

    @property
    def stands_out(self) -> bool:
        """Whether it is beyond chance, and beyond what else blocks have."""
        least = max(CERTAIN * self.per_second.standard_error, CUT * self.residual)
        return self.per_second.value > least

    @property
    def is_measured(self) -> bool:
        """Whether it stands out and is narrower than the widest that is tried: at that
        bound it may be any slope over the field."""
        return self.stands_out and self.extent.value < AT_END * EXTENTS[-1]


def glow(rate: Array) -> Glow:
    """Return the best glow in an (H, W) map of dark current, DN/s; nan is unknown."""
    across = min(FIELD_BLOCKS, *(side // 8 for side in rate.shape))
    smooth = np.array([median_of(b) for b in blocks_of(rate, across)])
    rows, cols = (centres(side, across) for side in rate.shape)
    half = math.hypot(*rate.shape) / 2
    ones, best = np.ones((len(smooth), 1)), None
    for row, col in PLACES:
        far = np.hypot(
            rows[:, None] - (row + 1) / 2 * rate.shape[0],
            cols[None] - (col + 1) / 2 * rate.shape[1],
        )
        found = fit_decay(ones, far.ravel() / half, smooth, EXTENTS)
        if found.height > 0 and (best is None or found.variance < best[0].variance):
            best = found, far.ravel() / half, row, col
    if best is None:
        none = Measured(0.0, float(np.std(smooth)), "DN/s")
        return Glow(none, 0, 0, Measured(1.0, 1.0, "1"), float(np.std(smooth)), 0)
    found, distance, row, col = best
    mean = float(np.exp(-distance / found.length).mean())
    return Glow(
        Measured(found.height, float(found.errors[1]), "DN/s"),
        row,
        col,
        Measured(found.length, float(found.errors[2]), "1"),
        math.sqrt(found.variance),
        found.height * mean,
    )


def median_of(block: Array) -> float:
    """Return the median of a block's pixels that are finite, 0 if none is."""
    known = block[np.isfinite(block)]
    return float(np.median(known)) if known.size else 0.0

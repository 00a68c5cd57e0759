# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Amplifier glow: a corner or edge of the dark current's map that is brighter."""

import math
from dataclasses import dataclass

import numpy as np

from cg2raw.calibration.decay import fit_decay
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.robust import CUT, Array
from cg2raw.calibration.sites import FIELD_BLOCKS, blocks_of, centres

EXTENTS = np.geomspace(0.03, 1.0, 15)  # half diagonals of the frame
# (row, column) of an amplifier, -1..1 of the frame: corners and middles of edges.
PLACES = tuple((r, c) for r in (-1.0, 0.0, 1.0) for c in (-1.0, 0.0, 1.0) if r or c)
CERTAIN = 5.0  # standard errors: of the best of 120 places and extents


@dataclass(frozen=True)
class Glow:
    """Charge of an amplifier's light: per_second exp(-d / extent), DN/s; d in half
    diagonals from (row, column): -1 is the top or left edge, 1 the bottom or right.
    smooth : (blocks, blocks) medians of the map of dark current, DN/s. residual : DN/s,
    what blocks have besides. median : DN/s, the glow of the median block."""

    per_second: Measured
    row: float
    column: float
    extent: Measured
    smooth: Array
    residual: float
    median: float

    def over(self, shape: tuple[int, ...]) -> Array:
        """Return (H, W) float32 of the glow over a frame, DN/s."""
        height, width = shape
        rows = (np.arange(height) + 0.5 - (self.row + 1) / 2 * height)[:, None]
        cols = np.arange(width) + 0.5 - (self.column + 1) / 2 * width
        far = np.hypot(rows.astype(np.float32), cols[None].astype(np.float32))
        far /= np.float32(-self.extent.value * math.hypot(height, width) / 2)
        found: Array = np.exp(far) * np.float32(self.per_second.value)
        return found

    @property
    def stands_out(self) -> bool:
        """Whether it is beyond chance, and beyond what else blocks have."""
        least = max(CERTAIN * self.per_second.standard_error, CUT * self.residual)
        return self.per_second.value > least

    @property
    def is_measured(self) -> bool:
        """Whether it stands out and is narrower than the widest that is tried: at that
        bound it may be any slope over the field."""
        return self.stands_out and self.extent.value < EXTENTS[-1]


def glow(rate: Array) -> Glow:
    """Return the best glow in an (H, W) map of dark current, DN/s."""
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
        if found.values[1] > 0 and (best is None or found.variance < best[0].variance):
            best = found, far.ravel() / half, row, col
    grid = smooth.reshape(len(rows), len(cols))
    if best is None:
        none = Measured(0.0, float(np.std(smooth)), "DN/s")
        return Glow(none, 0, 0, Measured(1.0, 1.0, "1"), grid, float(np.std(smooth)), 0)
    found, distance, row, col = best
    middle = float(np.median(np.exp(-distance / found.length)))
    return Glow(
        Measured(float(found.values[1]), float(found.errors[1]), "DN/s"),
        row,
        col,
        Measured(found.length, float(found.errors[2]), "1"),
        grid,
        math.sqrt(found.variance),
        float(found.values[1]) * middle,
    )


def median_of(block: Array) -> float:
    """Return the median of a block's pixels that are finite, 0 if none is."""
    known = block[np.isfinite(block)]
    return float(np.median(known)) if known.size else 0.0

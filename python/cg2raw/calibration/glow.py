# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Amplifier glow: a corner or edge of the dark current's map that is brighter."""

import math
from dataclasses import dataclass

import numpy as np

from cg2raw.calibration.measured import Measured
from cg2raw.calibration.robust import CUT, Array, clipped_moments
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

    @property
    def stands_out(self) -> bool:
        """Whether it is beyond chance, and beyond what else blocks have."""
        least = max(CERTAIN * self.per_second.standard_error, CUT * self.residual)
        return self.per_second.value > least


def glow(rate: Array) -> Glow:
    """Return the best glow in an (H, W) map of dark current, DN/s."""
    across = min(FIELD_BLOCKS, *(side // 8 for side in rate.shape))
    smooth = np.array([median_of(b) for b in blocks_of(rate, across)])
    rows, cols = (centres(side, across) for side in rate.shape)
    half = math.hypot(*rate.shape) / 2
    best: tuple[float, Array, Array, tuple[float, float], float] | None = None
    for row, col in PLACES:
        far = np.hypot(
            rows[:, None] - (row + 1) / 2 * rate.shape[0],
            cols[None] - (col + 1) / 2 * rate.shape[1],
        )
        for extent in EXTENTS:
            fall = np.exp(-far.ravel() / half / extent)
            design = np.stack([np.ones_like(fall), fall], 1)
            values, rest = _robust(design, smooth)
            squares = float(rest @ rest)
            if values[1] > 0 and (best is None or squares < best[0]):
                best = squares, values, design, (row, col), float(extent)
    grid = smooth.reshape(len(rows), len(cols))
    if best is None:
        none = Measured(0.0, float(np.std(smooth)), "DN/s")
        return Glow(none, 0, 0, Measured(1.0, 1.0, "1"), grid, float(np.std(smooth)), 0)
    squares, values, design, (row, col), extent = best
    sigma = math.sqrt(squares / (len(smooth) - 4))
    error = sigma * math.sqrt(float(np.linalg.pinv(design.T @ design)[1, 1]))
    step = extent * (EXTENTS[1] / EXTENTS[0] - 1)
    return Glow(
        Measured(float(values[1]), error, "DN/s"),
        row,
        col,
        Measured(extent, float(step) / 2, "1"),
        grid,
        sigma,
        float(np.median(values[1] * design[:, 1])),
    )


def median_of(block: Array) -> float:
    """Return the median of a block's pixels that are finite, 0 if none is."""
    known = block[np.isfinite(block)]
    return float(np.median(known)) if known.size else 0.0


def _robust(design: Array, y: Array) -> tuple[Array, Array]:
    """Return (least squares without what lies 4 sigma off, residuals cut there)."""
    values = np.linalg.lstsq(design, y, rcond=None)[0]
    rest = y - design @ values
    _, sigma, _ = clipped_moments(rest)
    keep = np.abs(rest) <= CUT * sigma
    values = np.linalg.lstsq(design[keep], y[keep], rcond=None)[0]
    return values, np.clip(y - design @ values, -CUT * sigma, CUT * sigma)

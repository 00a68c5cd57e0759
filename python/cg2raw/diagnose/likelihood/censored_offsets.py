# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Offsets that pixels share in frames whose noise the ADC cuts at 0.

Pixels at 0 show of their offset only that it was low enough: no filter whitens that.
The offset of each row and that of the frame are integrated out instead, by Laplace's
method: pixels that are cut or normal, and a normal prior, are log-concave in them, and
nearly normal.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import ndtri

from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.likelihood.censoring import scores

NEWTON_STEPS = 10
LEAST_STEP = 1e-7  # standard deviations, of a step
LEAST_CHANCE = 1e-12


@dataclass(frozen=True)
class OffsetVariances:
    """Of an offset that the pixels of a row share, and of one that all share."""

    row: float = 0.0
    frame: float = 0.0


@dataclass(frozen=True)
class CensoredOffsets:
    """A prediction with the offsets of a frame and of its rows.

    likeliest : for densities. drawn : with offsets from their posterior, for residuals,
    which are standard normal then. log_density : what integrating the offsets out adds,
    per pixel."""

    likeliest: Prediction
    drawn: Prediction
    log_density: Array


def censored_offsets(
    p: Prediction, variances: OffsetVariances, frame: Frame
) -> CensoredOffsets:
    """Return a prediction with offsets of rows and of the frame."""
    if variances.row <= 0 and variances.frame <= 0:
        return CensoredOffsets(p, p, np.zeros_like(p.mean))
    offsets = _Offsets(p, variances, frame)
    for _ in range(NEWTON_STEPS):
        if offsets.step() < LEAST_STEP:
            break
    likeliest, away = offsets.likeliest(), offsets.drawn_away()
    return CensoredOffsets(
        replace(p, mean=p.mean + likeliest),
        replace(p, mean=p.mean + likeliest + away),
        offsets.log_density() * frame.keep,
    )


class _Offsets:
    """The likeliest offsets of rows and frame, each in its standard deviations.

    rows : (T, h, 1), the same in tiles beside each other. whole : of the frame. The
    matrix of second derivatives is an arrow: rows on its diagonal, the frame along its
    edge; what is left of the edge is `rest`."""

    def __init__(self, p: Prediction, variances: OffsetVariances, frame: Frame) -> None:
        self._p, self._frame = p, frame
        self._of_row, self._of_frame = np.sqrt([variances.row, variances.frame])
        of_rows = frame.tiles.over_rows(np.ones_like(p.mean))
        self._once = p.mean.shape[2] / of_rows  # tiles beside each other share rows
        self._rows, self._whole = np.zeros_like(of_rows), 0.0

    def likeliest(self) -> Array:
        return np.asarray(self._of_row * self._rows + self._of_frame * self._whole)

    def _sum(self, of_rows: Array) -> float:
        return float((self._once * of_rows).sum())

    def _derivatives(self) -> tuple[Array, Array]:
        """Return (first derivative, minus the second) of each row's log density."""
        p, frame = self._p, self._frame
        z, _, weight = scores(replace(p, mean=p.mean + self.likeliest()), frame)
        # Pixels at white would show an offset as little, and are as good as none.
        used = np.where(frame.keep & ~frame.at_white, weight, 0) / np.sqrt(p.variance)
        return frame.tiles.over_rows(used * z), frame.tiles.over_rows(used**2)

    def _arrow(self, bend: Array) -> tuple[Array, Array, float]:
        """Return (diagonal, edge, rest of the edge)."""
        diagonal = 1 + self._of_row**2 * bend
        rest = 1 + self._of_frame**2 * self._sum(bend / diagonal)
        return diagonal, self._of_row * self._of_frame * bend, rest

    def step(self) -> float:
        """Take a step of Newton's method; return its largest part."""
        slope, bend = self._derivatives()
        diagonal, edge, rest = self._arrow(bend)
        of_rows = self._of_row * slope - self._rows
        of_frame = self._of_frame * self._sum(slope) - self._whole
        moved = (of_frame - self._sum(edge * of_rows / diagonal)) / rest
        of_rows = (of_rows - edge * moved) / diagonal
        self._rows, self._whole = self._rows + of_rows, self._whole + moved
        return float(max(abs(moved), np.abs(of_rows).max()))

    def log_density(self) -> Array:
        """Return what the integral adds to the density at its peak, per pixel."""
        diagonal, _, rest = self._arrow(self._derivatives()[1])
        tiles, keep = self._frame.tiles, self._frame.keep.astype(float)
        of_row = -0.5 * self._rows**2 - 0.5 * np.log(diagonal)
        of_frame = -0.5 * self._whole**2 - 0.5 * np.log(rest)
        count = np.maximum(tiles.over_rows(keep), 1)
        return np.asarray(of_row / count + of_frame / max(keep.sum(), 1))

    def drawn_away(self) -> Array:
        """Return a draw of how far the offsets lie from the likeliest ones."""
        diagonal, edge, rest = self._arrow(self._derivatives()[1])
        frame = self._frame
        # A sum of uniform numbers is uniform on the circle; tiles of a row share it.
        turn = frame.tiles.over_rows(frame.uniform[:, :, :1]) % 1
        whole = _normal(frame.uniform[:, :, -1].sum() % 1) / np.sqrt(rest)
        rows = _normal(turn) / np.sqrt(diagonal) - edge * whole / diagonal
        return np.asarray(self._of_row * rows + self._of_frame * whole)


def _normal(uniform: Array) -> Array:
    return np.asarray(ndtri(np.clip(uniform, LEAST_CHANCE, 1 - LEAST_CHANCE)))

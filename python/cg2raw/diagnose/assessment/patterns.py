# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Patterns: what frames without an image have in common beyond what is predicted."""

from collections.abc import Sequence

import numpy as np

from cg2raw.cfa import repeat_of
from cg2raw.diagnose.diagnosis import FixedPattern
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array, Mask

ACROSS = 256  # cells of a map along its longer side
# Standard deviations from the middle of its tile that a pixel counts at most: one hot
# pixel is no column, and no cell.
MOST_OF_ONE = 10.0


class PatternSums:
    """Sums of the residuals of one frame, before and after, piece by piece."""

    def __init__(self, frame: Frame, cfa: str) -> None:
        self.kind, self.shape = frame.capture.kind, frame.tiles.shape
        repeat = repeat_of(cfa)
        step = max(1, -(-max(self.shape) // ACROSS))
        self._cell = -(-step // repeat) * repeat if step > 1 else 1
        height, width = self.shape
        cells = -(-height // self._cell), -(-width // self._cell)
        # Sums before, after, and the number of pixels.
        self.cells = np.zeros((3, *cells))
        self.rows, self.columns = np.zeros((3, height)), np.zeros((3, width))

    def add(self, piece: Frame, before: Prediction, after: Prediction) -> None:
        """Count the pixels of a piece that are used."""
        used = piece.keep & ~piece.censored
        parts = np.stack([_bounded(piece, p, used) for p in (before, after)])
        counted = np.concatenate([parts, used[None]])
        rows, columns = piece.tiles.rows_and_columns()
        for n, (row, column) in enumerate(
            zip(rows[:, :, 0], columns[:, 0], strict=True)
        ):
            tile = counted[:, n]
            self.rows[:, row] += tile.sum(2)
            self.columns[:, column] += tile.sum(1)
            down, first_rows = np.unique(row // self._cell, return_index=True)
            across, first_columns = np.unique(column // self._cell, return_index=True)
            sums = np.add.reduceat(tile, first_rows, axis=1)
            sums = np.add.reduceat(sums, first_columns, axis=2)
            self.cells[:, down[0] : down[-1] + 1, across[0] : across[-1] + 1] += sums


def _bounded(piece: Frame, p: Prediction, used: Mask) -> Array:
    """Return residuals of a piece in DN, 0 where they are not used."""
    residual = np.where(used, (piece.signal - p.mean) * piece.range, 0.0)
    most = MOST_OF_ONE * np.sqrt(p.variance) * piece.range
    for tile, bound, mask in zip(residual, most, used, strict=True):
        if mask.any():
            middle = np.median(tile[mask])
            np.clip(tile, middle - bound, middle + bound, out=tile, where=mask)
    return residual


def is_uniform(frame: Frame) -> bool:
    """Whether a frame shows a fixed pattern and nothing in front of it."""
    return not frame.capture.shows.image and frame.samples is None


def patterns_of(sums: Sequence[PatternSums]) -> list[FixedPattern]:
    """Return the mean of the frames of each kind; of one shape, the first."""
    found = []
    for kind in dict.fromkeys(each.kind for each in sums):
        same = [each for each in sums if each.kind == kind]
        same = [each for each in same if each.shape == same[0].shape]
        cells, rows, columns = (
            _means([getattr(each, name) for each in same])
            for name in ("cells", "rows", "columns")
        )
        found.append(
            FixedPattern(
                kind=kind,
                frames=len(same),
                before=cells[0],
                after=cells[1],
                rows_before=rows[0],
                rows_after=rows[1],
                columns_before=columns[0],
                columns_after=columns[1],
            )
        )
    return found


def _means(sums: Sequence[Array]) -> tuple[Array, Array]:
    """Return means before and after of (3, ...) sums and counts; NaN of none."""
    before, after, count = np.sum(sums, axis=0)
    count = np.where(count > 0, count, np.nan)
    return before / count, after / count

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Pictures: frames side by side, residual maps, histograms."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cg2raw.cfa import demosaic, repeat_of
from cg2raw.diagnose.captures.consistency import LEAST_SIDE
from cg2raw.diagnose.diagnosis import Picture
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.scenes.point import Point

LARGEST_SIDE = 512
FARTHEST_Z = 20.0
CELL = LEAST_SIDE  # pixels a side of a cell of the residual map, at least
EDGES = np.linspace(-6, 6, 97)


class Canvas:
    """A picture of one frame that grows piece by piece; NaN where none was mounted."""

    def __init__(self, frame: Frame, cfa: str) -> None:
        self._frame, self._cfa = frame, cfa
        repeat = repeat_of(cfa)
        short, side = sorted(frame.tiles.shape)
        scale = max(1, -(-side // LARGEST_SIDE))
        whole = -(-scale // repeat) * repeat if scale > 1 else 1
        self._scale = max(1, min(whole, short // repeat * repeat))  # fits a line scan
        self._cell = max(CELL, self._scale)
        colors = self._shape(self._scale)
        cells = self._shape(self._cell)
        self._images = [np.full((*colors, 3), np.nan, np.float32) for _ in range(3)]
        self._maps = [np.full(cells, np.nan, np.float32) for _ in range(2)]

    def _shape(self, scale: int) -> tuple[int, int]:
        height, width = self._frame.tiles.shape
        return -(-height // scale), -(-width // scale)

    def mount(
        self, piece: Frame, before: Array, after: Array, *residuals: Array
    ) -> None:
        """Put the tiles of a piece in their places.

        before, after : predicted means. residuals : standardised, before and after."""
        signals = (piece.signal, np.clip(before, 0, 1), np.clip(after, 0, 1))
        for image, signal in zip(self._images, signals, strict=True):
            planes = [
                np.asarray(demosaic(np.ascontiguousarray(tile, "f4"), self._cfa))
                for tile in signal
            ]
            _mount(image, np.stack(planes), piece, self._scale)
        used = piece.keep & ~piece.censored
        for canvas, z in zip(self._maps, residuals, strict=True):
            shown = np.where(used, np.clip(z, -FARTHEST_Z, FARTHEST_Z), 0)
            _mount(canvas, shown * self._cell, piece, self._cell)

    def picture(self) -> Picture:
        """Return the picture as it is."""
        capture, neutral = self._frame.capture, np.array(self._frame.neutral)
        measured, before, after = self._images
        z_before, z_after = self._maps
        return Picture(
            name=capture.name,
            kind=capture.kind,
            measured=measured,
            before=before,
            after=after,
            z_before=z_before,
            z_after=z_after,
            neutral=tuple(neutral / neutral[1]),
        )


def _mount(canvas: Array, tiles: Array, frame: Frame, scale: int) -> None:
    """Write the means of cells of scale pixels into a canvas."""
    rows, columns = frame.tiles.rows_and_columns()
    for tile, row, col in zip(tiles, rows[:, 0, 0], columns[:, 0, 0], strict=True):
        # Whole cells of the canvas that lie in the tile.
        top, left = -(-row // scale), -(-col // scale)
        inner = tile[top * scale - row :, left * scale - col :]
        h, w = (n // scale for n in inner.shape[:2])
        cells = inner[: h * scale, : w * scale].reshape(h, scale, w, scale, -1)
        mean = cells.mean((1, 3)).reshape(h, w, *tile.shape[2:])
        canvas[top : top + h, left : left + w] = mean


def histogram(points: Sequence[Point]) -> tuple[Array, Array]:
    """Return (edges, counts) of the standardised residuals of views."""
    every = [np.zeros(0), *(point.z[point.root > 0] for point in points)]
    counts = np.histogram(np.clip(np.concatenate(every), EDGES[0], EDGES[-1]), EDGES)
    return EDGES, counts[0]


def pictures_of(before: Sequence[Point], after: Sequence[Point]) -> list[Picture]:
    """Return a picture of each view of a scene or chart, of the tiles worked on."""
    found = []
    for first, last in zip(before, after, strict=True):
        frame = last.frame
        if frame.samples is not None:
            continue
        canvas = Canvas(frame, last.model.sensor.cfa)
        seen = replace(frame, signal=last.view.signal)
        canvas.mount(seen, first.mean, last.mean, first.z, last.z)
        found.append(canvas.picture())
    return found

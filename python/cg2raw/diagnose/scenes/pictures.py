# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Pictures: frames side by side, residual maps, histograms."""

from collections.abc import Sequence

import numpy as np

from cg2raw.cfa import demosaic, repeat_of
from cg2raw.diagnose.captures.consistency import LEAST_SIDE
from cg2raw.diagnose.diagnosis import Picture
from cg2raw.diagnose.frames.tiling import Array, Tiling
from cg2raw.diagnose.scenes.point import Point

LARGEST_SIDE = 512
FARTHEST_Z = 20.0
CELL = LEAST_SIDE  # pixels a side of a cell of the residual map, at least
EDGES = np.linspace(-6, 6, 97)


def pictures_of(before: Sequence[Point], after: Sequence[Point]) -> list[Picture]:
    """Return a picture of each view of a scene or chart, of the tiles worked on."""
    return [
        _picture(first, last)
        for first, last in zip(before, after, strict=True)
        if last.frame.samples is None
    ]


def _picture(first: Point, last: Point) -> Picture:
    """Return that of a view, as predicted before and after."""
    frame, cfa = last.frame, last.model.sensor.cfa
    scale, neutral = scale_of(frame.tiles.shape, cfa), np.array(frame.neutral)
    cell = max(CELL, scale)
    used = frame.keep & ~frame.censored

    def image(signal: Array) -> Array:
        planes = [
            np.asarray(demosaic(np.ascontiguousarray(tile, "f4"), cfa))
            for tile in signal
        ]
        return _mounted(np.stack(planes), frame.tiles, scale)

    def residual_map(z: Array) -> Array:
        shown = np.where(used, np.clip(z, -FARTHEST_Z, FARTHEST_Z), 0)
        return _mounted(shown * cell, frame.tiles, cell)

    return Picture(
        name=frame.capture.name,
        kind=frame.capture.kind,
        measured=image(last.view.signal),
        before=image(np.clip(first.mean, 0, 1)),
        after=image(np.clip(last.mean, 0, 1)),
        z_before=residual_map(first.z),
        z_after=residual_map(last.z),
        neutral=tuple(neutral / neutral[1]),
    )


def scale_of(shape: tuple[int, int], cfa: str) -> int:
    """Return the side of a picture's cells, in pixels of a frame (H, W): whole repeats
    of its CFA, or 1."""
    repeat = repeat_of(cfa)
    short, side = sorted(shape)
    scale = max(1, -(-side // LARGEST_SIDE))
    whole = -(-scale // repeat) * repeat if scale > 1 else 1
    return max(1, min(whole, short // repeat * repeat))  # fits a line scan


def _mounted(pieces: Array, tiles: Tiling, scale: int) -> Array:
    """Return the means of cells of scale pixels of a frame, where it has tiles; NaN
    elsewhere. pieces : (T, h, w, ...) of the tiles."""
    height, width = tiles.shape
    size = -(-height // scale), -(-width // scale)
    canvas = np.full((*size, *pieces.shape[3:]), np.nan, np.float32)
    rows, columns = tiles.rows_and_columns()
    for tile, row, col in zip(pieces, rows[:, 0, 0], columns[:, 0, 0], strict=True):
        # Whole cells of the canvas that lie in the tile.
        top, left = -(-row // scale), -(-col // scale)
        inner = tile[top * scale - row :, left * scale - col :]
        h, w = (n // scale for n in inner.shape[:2])
        cells = inner[: h * scale, : w * scale].reshape(h, scale, w, scale, -1)
        mean = cells.mean((1, 3)).reshape(h, w, *tile.shape[2:])
        canvas[top : top + h, left : left + w] = mean
    return canvas


def histogram(points: Sequence[Point]) -> tuple[Array, Array]:
    """Return (edges, counts) of the standardised residuals of views."""
    every = [np.zeros(0), *(point.z[point.root > 0] for point in points)]
    counts = np.histogram(np.clip(np.concatenate(every), EDGES[0], EDGES[-1]), EDGES)
    return EDGES, counts[0]

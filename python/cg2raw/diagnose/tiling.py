# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Tiling: which pieces of a frame are worked on."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]  # of float64
Mask = NDArray[Any]  # of bool

TILE = (96, 128)  # rows, columns of the pieces of a large frame
WHOLE_TILE = 252  # pixels a side, where all of a frame is gone through
BATCH = 16  # such tiles at a time
MARGIN = 24  # pixels around a tile that blur and aberrations take in
MOST_MASKED = 6  # tiles' pixels for one that counts


@dataclass(frozen=True)
class Tiling:
    """Where the tiles of a frame lie; the same in all frames of one shape.

    origins : (T, 2) row and column of each tile's first pixel, margin included; a
        multiple of the CFA's repeat.
    size : rows and columns of a tile without its margin.
    """

    shape: tuple[int, int]
    size: tuple[int, int]
    margin: int
    origins: NDArray[np.int32]

    def cut(self, image: NDArray[Any], with_margin: bool = False) -> NDArray[Any]:
        """Return the tiles (T, h, w, ...) of an image (H, W, ...)."""
        inset = 0 if with_margin else self.margin
        height, width = (n + 2 * (self.margin - inset) for n in self.size)
        return np.stack(
            [
                image[r + inset : r + inset + height, c + inset : c + inset + width]
                for r, c in self.origins
            ]
        )

    def over_rows(self, image: Array) -> Array:
        """Return sums over rows of tiles (T, h, w), as (T, h, 1); tiles beside each
        other share their rows."""
        return self._shared(image.sum(2), self.origins[:, 0])[:, :, None]

    def over_columns(self, image: Array) -> Array:
        """Return sums over columns of tiles (T, h, w), as (T, 1, w); tiles above each
        other share their columns."""
        return self._shared(image.sum(1), self.origins[:, 1])[:, None]

    @staticmethod
    def _shared(lines: Array, starts: NDArray[np.int32]) -> Array:
        _, group = np.unique(starts, return_inverse=True)
        sums = np.zeros((int(group.max()) + 1, lines.shape[1]))
        np.add.at(sums, group, lines)
        return np.asarray(sums[group])

    def rows_and_columns(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the row (T, h, 1) and column (T, 1, w) of every pixel."""
        first = self.origins.astype(np.int64) + self.margin
        rows = first[:, :1, None] + np.arange(self.size[0])[None, :, None]
        columns = first[:, 1:, None] + np.arange(self.size[1])[None, None, :]
        return rows, columns

    def field(self) -> tuple[Array, Array]:
        """Return (u, v): offset from the centre in half diagonals; (T, h, w) each."""
        height, width = self.shape
        half = np.hypot(height, width) / 2
        rows, columns = self.rows_and_columns()
        u = (columns + 0.5 - width / 2) / half
        v = (rows + 0.5 - height / 2) / half
        shape = np.broadcast_shapes(u.shape, v.shape)
        return np.broadcast_to(u, shape), np.broadcast_to(v, shape)


def tiling(
    shape: tuple[int, int], pixels: int, repeat: int = 2, wanted: Mask | None = None
) -> Tiling:
    """Return tiles that hold about so many pixels of a frame, corners among them.

    wanted : (H, W), where any frame counts; if that is less than half, tiles lie where
        most of it is."""
    height, width = shape
    if height * width <= 1.5 * pixels or min(shape) < 2 * MARGIN + max(TILE):
        return Tiling(shape, shape, 0, np.zeros((1, 2), np.int32))
    size = (TILE[0] - TILE[0] % repeat, TILE[1] - TILE[1] % repeat)
    if wanted is not None and wanted.mean() < 0.5:
        origins = _where_wanted(wanted, size, pixels, repeat)
    else:
        across = max(2, round(np.sqrt(pixels / (size[0] * size[1]) * width / height)))
        down = max(2, round(pixels / (size[0] * size[1] * across)))
        origins = np.array(
            [
                (row, column)
                for row in _places(height, size[0], down, repeat)
                for column in _places(width, size[1], across, repeat)
            ]
        )
    return Tiling(shape, size, MARGIN, origins.astype(np.int32))


def _places(length: int, tile: int, count: int, repeat: int) -> NDArray[np.int64]:
    """Return the first pixels of tiles from one end to the other, at most so many and
    none on another: a pixel counts once."""
    count = min(count, (length - 2 * MARGIN) // tile)
    places = np.linspace(0, length - tile - 2 * MARGIN, count).astype(np.int64)
    return places - places % repeat


def _where_wanted(
    wanted: Mask, size: tuple[int, int], pixels: int, repeat: int
) -> NDArray[np.int64]:
    """Return tiles beside each other that hold most of what counts."""
    rows, columns = (
        _places(n, tile, (n - 2 * MARGIN) // tile, repeat)
        for n, tile in zip(wanted.shape, size, strict=True)
    )
    held = {
        (row, column): int(
            wanted[
                row + MARGIN : row + MARGIN + size[0],
                column + MARGIN : column + MARGIN + size[1],
            ].sum()
        )
        for row in rows
        for column in columns
    }
    chosen: list[tuple[int, int]] = []
    sum_ = 0
    for place in sorted(held, key=lambda at: -held[at]):
        if held[place] == 0 or sum_ > pixels:
            break
        if len(chosen) * size[0] * size[1] > MOST_MASKED * pixels:
            break
        chosen.append(place)
        sum_ += held[place]
    return np.array(sorted(chosen) or [(0, 0)])


def whole_tilings(tiles: Tiling, repeat: int = 2) -> Iterator[Tiling]:
    """Yield tilings that together are a frame without its outermost MARGIN pixels."""
    if tiles.margin == 0:
        yield tiles
        return
    inner = [n - 2 * MARGIN for n in tiles.shape]
    # The fewest pieces, all of one size: their number times the repeat is left over.
    size = [n // -(-n // WHOLE_TILE) // repeat * repeat for n in inner]
    places = [range(0, n - tile + 1, tile) for n, tile in zip(inner, size, strict=True)]
    origins = np.array([(r, c) for r in places[0] for c in places[1]], np.int32)
    for first in range(0, len(origins), BATCH):
        batch = origins[first : first + BATCH]
        yield Tiling(tiles.shape, (size[0], size[1]), MARGIN, batch)

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Tiling: the pieces of a frame that are worked on."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw import _core

Array = NDArray[Any]  # of float64
Mask = NDArray[Any]  # of bool

LARGEST_TILE = 96  # rows of a piece of a large frame; its columns are 4/3 of them
SMALLEST_TILE, STEP_OF_TILES = 18, 6  # a multiple of any CFA's repeat
FEWEST_TILES = 5  # pieces along each side: both ends, the middle and between
NARROW = 176  # pixels: a border of masked pixels is taken whole
REACH = sum(effect["reach"] for effect in _core.effects())  # of all, px
MARGIN = -(-REACH // STEP_OF_TILES) * STEP_OF_TILES  # pixels around a tile
MOST_MASKED = 6  # tiles' pixels for one that counts


@dataclass(frozen=True)
class Tiling:
    """Where the tiles of a frame lie; the same in all frames of one shape.

    origins : (T, 2) row and column of each tile's first pixel, a multiple of the CFA's
        repeat.
    size : rows and columns of a tile.
    margin : pixels around a tile that are read with it. Where the frame ends within
        them, the block of both is moved into the frame.
    """

    shape: tuple[int, int]
    size: tuple[int, int]
    margin: int
    origins: NDArray[np.int32]

    @property
    def block_size(self) -> tuple[int, int]:
        """Rows and columns of a tile with its margin."""
        return self.size[0] + 2 * self.margin, self.size[1] + 2 * self.margin

    @property
    def blocks(self) -> NDArray[np.int32]:
        """(T, 2) row and column of the first pixel of each tile with its margin."""
        last = np.subtract(self.shape, self.block_size)
        return np.clip(self.origins - self.margin, 0, last)

    def cut(self, image: NDArray[Any], with_margin: bool = False) -> NDArray[Any]:
        """Return the tiles (T, h, w, ...) of an image (H, W, ...)."""
        height, width = self.block_size if with_margin else self.size
        places = self.blocks if with_margin else self.origins
        return np.stack([image[r : r + height, c : c + width] for r, c in places])

    def inner(self, blocks: NDArray[Any]) -> NDArray[Any]:
        """Return (T, C, h, w) of blocks with their margins, (T, C, H, W)."""
        (height, width), insets = self.size, self.origins - self.blocks
        pairs = zip(blocks, insets, strict=True)
        return np.stack([b[:, r : r + height, c : c + width] for b, (r, c) in pairs])

    def rows_and_columns(
        self, with_margin: bool = False
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the row (T, h, 1) and column (T, 1, w) of every pixel."""
        height, width = self.block_size if with_margin else self.size
        first = (self.blocks if with_margin else self.origins).astype(np.int64)
        rows = first[:, :1, None] + np.arange(height)[None, :, None]
        columns = first[:, 1:, None] + np.arange(width)[None, None, :]
        return rows, columns

    def places(self, with_margin: bool = False) -> tuple[Array, Array]:
        """Return (v, u): offset of rows (T, h, 1) and columns (T, 1, w) from the
        centre, in half diagonals."""
        half = np.hypot(*self.shape) / 2
        rows, columns = self.rows_and_columns(with_margin)
        v = (rows + 0.5 - self.shape[0] / 2) / half
        u = (columns + 0.5 - self.shape[1] / 2) / half
        return v, u

    def field(self) -> tuple[Array, Array]:
        """Return (u, v): the same of every pixel of the tiles, (T, h, w) each."""
        v, u = np.broadcast_arrays(*self.places())
        return u, v


def tiling(
    shape: tuple[int, int], pixels: int, repeat: int = 2, wanted: Mask | None = None
) -> Tiling:
    """Return tiles that hold about so many pixels of a frame: its corners, its edges
    and its middle are among them, whatever its size.

    wanted : (H, W), where any frame counts; if that is less than half, tiles lie where
        most of it is."""
    height, width = shape
    size = _size_of_tiles(pixels, repeat)
    narrow = max(NARROW, FEWEST_TILES * max(size))
    if height * width <= 1.5 * pixels or min(shape) < narrow:
        return Tiling(shape, shape, 0, np.zeros((1, 2), np.int32))
    if wanted is not None and wanted.mean() < 0.5:
        origins = _where_wanted(wanted, size, pixels, repeat)
    else:
        count = pixels / (size[0] * size[1])
        fewer = _odd(np.sqrt(count * min(shape) / max(shape)))
        more = _odd(count / fewer)
        down, across = (fewer, more) if height < width else (more, fewer)
        rows = _places(height, size[0], down, repeat)
        columns = _places(width, size[1], across, repeat)
        origins = np.array([(row, column) for row in rows for column in columns])
    return Tiling(shape, size, MARGIN, origins.astype(np.int32))


def _size_of_tiles(pixels: int, repeat: int) -> tuple[int, int]:
    """Return (rows, columns) of tiles of which the fewest hold so many pixels."""
    rows = np.sqrt(0.75 * pixels / FEWEST_TILES**2) // STEP_OF_TILES * STEP_OF_TILES
    rows = int(np.clip(rows, SMALLEST_TILE, LARGEST_TILE))
    columns = rows * 4 // 3
    return rows - rows % repeat, columns - columns % repeat


def _odd(count: float) -> int:
    """Return an odd number of pieces near a number, so that one lies in the middle."""
    return max(FEWEST_TILES, 2 * round((count - 1) / 2) + 1)


def _places(length: int, tile: int, count: int, repeat: int) -> NDArray[np.int64]:
    """Return the first pixels of tiles from one end to the other, at most so many and
    none on another: a pixel counts once."""
    count = min(count, length // tile)
    places = np.linspace(0, length - tile, count).astype(np.int64)
    return places - places % repeat


def _where_wanted(
    wanted: Mask, size: tuple[int, int], pixels: int, repeat: int
) -> NDArray[np.int64]:
    """Return tiles that hold most of what counts; if many do, some from all over."""
    rows, columns = (
        _places(n, tile, n // tile, repeat)
        for n, tile in zip(wanted.shape, size, strict=True)
    )
    places = np.array([(row, column) for row in rows for column in columns])
    held = np.array([wanted[r : r + size[0], c : c + size[1]].sum() for r, c in places])
    full = np.flatnonzero(2 * held > held.max())
    enough = -(-pixels * len(full) // max(int(held[full].sum()), 1))
    if len(full) > enough:
        chosen = full[np.linspace(0, len(full) - 1, enough).astype(int)]
    else:
        most = -(-MOST_MASKED * pixels // (size[0] * size[1]))
        order = np.argsort(-held, kind="stable")
        before = np.cumsum(held[order]) - held[order]
        chosen = order[(before <= pixels) & (held[order] > 0)][:most]
    return places[np.sort(chosen)] if len(chosen) else places[:1]

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Patterns of flats that are set apart, as masked samples, before all else is measured:
a lattice of pixels, and spots."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CHANCE = 0.01  # of a lattice that is set apart where none is


@dataclass(frozen=True)
class Lattice:
    """pitch, row, column : px, of the first pixel in the mosaic. nats : by how many its
    pixels differ from their neighbours, over no difference; of the middle of the frame.
    tried : how many lattices it was chosen from."""

    pitch: int
    row: int
    column: int
    nats: float
    tried: int

    @property
    def is_sure(self) -> bool:
        """Whether chance brings one of all that were tried less often than CHANCE."""
        return self.nats > math.log(self.tried / CHANCE)

    def samples(self, shape: tuple[int, int]) -> NDArray[np.bool_]:
        """Return (H, W), True in its pixels."""
        found = np.zeros(shape, bool)
        found[self.row :: self.pitch, self.column :: self.pitch] = True
        return found


@dataclass(frozen=True)
class Spots:
    """places : (N, 3) px: row, column, and the radius that has all of a spot. tried :
    how many places and sizes there were, in which chance could have brought one."""

    places: Array
    tried: int

    def samples(self, shape: tuple[int, int]) -> NDArray[np.bool_]:
        """Return (H, W), True in the spots."""
        found: NDArray[np.bool_] = self.numbers(shape) > 0
        return found

    def numbers(self, shape: tuple[int, int]) -> NDArray[np.int64]:
        """Return (H, W) which spot a pixel is of, from 1 on, 0 in none; of several the
        one whose middle is nearest."""
        found, nearest = np.zeros(shape, np.int64), np.full(shape, np.inf)
        for number, (row, column, radius) in enumerate(self.places, 1):
            window, away = disc(row, column, radius, shape)
            closer = away < np.minimum(nearest[window], radius + 1e-9)
            found[window][closer] = number
            nearest[window][closer] = away[closer]
        return found


def disc(
    row: float, column: float, radius: float, shape: tuple[int, int]
) -> tuple[tuple[slice, slice], Array]:
    """Return the window of a frame that holds a disc, and how far its pixels are from
    the middle."""
    rows, columns = (
        slice(max(int(at - radius), 0), min(int(at + radius) + 2, length))
        for at, length in zip((row, column), shape, strict=True)
    )
    y, x = np.mgrid[rows, columns]
    return (rows, columns), np.hypot(y - row, x - column)

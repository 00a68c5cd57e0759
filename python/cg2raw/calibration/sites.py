# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Sites: the planes of a CFA repeat, and blocks of pixels in each."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from cg2raw.cfa import is_mono
from cg2raw.sensor import Sensor
from cg2raw.statistics.codes import COARSE, ROUNDING
from cg2raw.statistics.constant import BLOCKS

Number = TypeVar("Number", bound=np.generic)
LEAST_REPEATS = 3 * BLOCKS  # of the CFA along each side: three to a block
FIELD_BLOCKS = 32  # along each side of a frame, of maps of light and of dark current


@dataclass(frozen=True)
class Sites:
    """The CFA sites of a sensor in raster order of its square repeat; one if it has no
    CFA. step : DN between neighbouring codes of the frames."""

    names: tuple[str, ...]
    step: int = 1

    @property
    def count(self) -> int:
        """How many there are, and black levels in a profile."""
        return len(self.names)

    @property
    def rounding(self) -> float:
        """Variance of rounding to the codes, DN^2."""
        return ROUNDING * self.step**2

    @property
    def coarse(self) -> float:
        """Variance below which rounding hides it, DN^2."""
        return COARSE * self.step**2

    @property
    def side(self) -> int:
        """Pixels along the repeat."""
        return math.isqrt(self.count)

    def of(self, plane: NDArray[Number]) -> list[NDArray[Number]]:
        """Return the views (h, w) of each site of an (H, W) plane."""
        return [
            plane[r :: self.side, c :: self.side]
            for r, c in np.ndindex(2 * (self.side,))
        ]

    def spread(self, values: Any, shape: tuple[int, int]) -> NDArray[np.float32]:
        """Return (H, W) float32 with the value of each site."""
        found = np.empty(shape, np.float32)
        for plane, value in zip(self.of(found), values, strict=True):
            plane[:] = value
        return found


def sites_of(sensor: Sensor) -> Sites:
    """Return the sites of a sensor, named by their colours where it has any; of a Bayer
    CFA, Gr is the green beside red."""
    if is_mono(sensor.cfa):
        return Sites(("",))
    letters = sensor.cfa.upper()
    names = [
        f"{letter}{letters[:n].count(letter)}" if letters.count(letter) > 1 else letter
        for n, letter in enumerate(letters, 1)
    ]
    if len(names) == 4:
        in_red_row = names[:2] if "R" in names[:2] else names[2:]
        greens = {name: "Gr" if name in in_red_row else "Gb" for name in ("G1", "G2")}
        names = [greens.get(name, name) for name in names]
    return Sites(tuple(names))


def blocks_of(plane: NDArray[Number], across: int) -> Iterator[NDArray[Number]]:
    """Yield the views of across x across blocks of a plane, row by row; together they
    are all of it."""
    rows, cols = (edges(length, across) for length in plane.shape)
    for top, bottom in pairwise(rows):
        for left, right in pairwise(cols):
            yield plane[top:bottom, left:right]


def edges(length: int, across: int) -> list[int]:
    """Return where blocks of a side begin and end; no more of them than pixels."""
    return [int(e) for e in np.linspace(0, length, min(across, length) + 1)]


def centres(length: int, across: int, side: int = 1) -> NDArray[np.float64]:
    """Return the middles of the blocks along a side, px.

    side : of the CFA repeat, where blocks are of the planes of its sites."""
    ends = np.array(edges(length // side, across), float) * side
    return np.asarray((ends[1:] + ends[:-1]) / 2)

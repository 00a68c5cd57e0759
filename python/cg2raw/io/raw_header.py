# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""RawFile: one RAW frame of a file of any format, and what its header says."""

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cg2raw.arrays import RawImage
from cg2raw.sensor import Sensor

MOST_DN = 65535


class Levels(NamedTuple):
    """Of a sensor, DN: mean black level, and white level."""

    black: float
    white: int


@dataclass(frozen=True)
class Area:
    """A rectangle of the stored mosaic, px."""

    name: str  # "active", "left", "top", "right", "bottom"
    top: int
    left: int
    height: int
    width: int


@dataclass(frozen=True)
class RawHeader:
    """What a RAW file says of one of its frames; None or empty: it does not say.

    frame : name of one of several frames in a file; empty: the file's.
    active, borders : a border begins at a whole repeat of the CFA from the active area.
    cfa : letters of the sites, phase of the active area's corner.
    depth : bits of the converter; DN may be these times a power of two.
    black_level : DN, one per CFA site, or one.
    as_shot : camera RGB of the neutral. camera_from_xyz : 9 numbers, row major, D65.
    exposure_time : s. temperature : of the sensor, degrees Celsius.
    electrons_per_dn : inverse of the system gain.
    settings : {keyword: value} of what changes the numbers of a frame, in the words of
    the file: gain, offset, mode of read-out, binning, camera.
    notes : sentences on what was assumed of the file."""

    path: str
    active: Area
    borders: tuple[Area, ...] = ()
    frame: str = ""
    make: str = ""
    model: str = ""
    cfa: str | None = None
    bits: int | None = None
    depth: int | None = None
    black_level: tuple[float, ...] | None = None
    white_level: int | None = None
    as_shot: tuple[float, ...] | None = None
    camera_from_xyz: tuple[float, ...] | None = None
    iso: float | None = None
    exposure_time: float | None = None
    temperature: float | None = None
    electrons_per_dn: float | None = None
    settings: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """What messages call the frame."""
        return self.frame or os.path.basename(self.path)

    @property
    def where(self) -> str:
        """The file's path, and which of its frames."""
        return f"{self.path} ({self.frame})" if self.frame else self.path

    @property
    def shape(self) -> tuple[int, int]:
        """(H, W) of the active area."""
        return self.active.height, self.active.width


@dataclass(frozen=True)
class RawFile:
    """A RAW frame: its header, and its pixels, which are read when they are needed.

    read : (levels of the sensor, if known) -> (H, W) uint16 DN of all that is stored,
    top row first. A frame with overscan is moved so that its bias is the black level.
    """

    header: RawHeader
    read: Callable[[Levels | None], RawImage]

    def mosaic(
        self, area: Area | None = None, sensor: Sensor | None = None
    ) -> RawImage:
        """Return (height, width) uint16 DN of an area, the active one if not given.

        Raises ValueError, OSError."""
        area = area or self.header.active
        levels = None
        if sensor is not None:
            levels = Levels(float(np.mean(sensor.black_level)), sensor.white_level)
        rows = slice(area.top, area.top + area.height)
        cols = slice(area.left, area.left + area.width)
        plane = np.array(self.read(levels)[rows, cols])
        if plane.shape != (area.height, area.width):
            raise ValueError(
                f"{self.header.path}: was changed while it was read; start again"
            )
        return plane


def whole_dn(
    path: str, plane: NDArray[Any], pedestal: float = 0.0
) -> NDArray[np.float64]:
    """Return pixels less a pedestal. Raises ValueError for the first that is no DN."""
    without = plane.astype(np.float64) - pedestal
    with np.errstate(invalid="ignore"):
        wrong = ~((without >= 0) & (without <= MOST_DN) & (without == np.rint(without)))
    if wrong.any():
        row, col = np.argwhere(wrong)[0]
        less = f" without its PEDESTAL of {pedestal:g} DN" if pedestal else ""
        raise ValueError(
            f"{path}: {np.count_nonzero(wrong)} pixels are no DN, the first in stored "
            f"row {row}, column {col}: {without[row, col]:g}{less}; must be whole "
            f"numbers, 0 to {MOST_DN}: give the frame as the camera took it, not "
            "calibrated"
        )
    return without

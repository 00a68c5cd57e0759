# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Measurements: all that darks and flats show of a sensor, each with its error."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cg2raw.calibration.dark_spread import DarkSpread
from cg2raw.calibration.darks import DarkCurrent, Map
from cg2raw.calibration.defects import Defects
from cg2raw.calibration.fitting import Fitted, of_all, of_sites
from cg2raw.calibration.light import Light, Linearity
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.photon_transfer import PhotonTransfer
from cg2raw.calibration.sites import Sites
from cg2raw.calibration.structure import BiasStructure, Glow
from cg2raw.calibration.tails import Tails
from cg2raw.sensor import Sensor


@dataclass(frozen=True)
class Transients:
    """Pixels of single frames far above their repeats: cosmic rays, or flicker."""

    group: str
    count: int
    frames: int


@dataclass(frozen=True)
class Measurements:
    """What frames of uniform light and of none show; None where they cannot, and why
    is in the notes.

    sensor : whose profile was given. iso : of the frames, None if nobody says it.
    shape : (H, W) px. frames : (darks, flats). fit : figures by one likelihood, and why
    darks do not show all of them.
    repeats : how many of the shortest darks repeat each other, group by group.
    lamp : relative, standard deviation of the flats' light. offset, rate, response :
    (H, W) float32 of each pixel, DN above black, DN/s but for a constant, relative.
    clipped : number of flats that show saturation alone. faint : of flats whose noise
    is rounding's. excluded : {name of a frame that is none of its repeats: how it is
    off}."""

    sensor: Sensor
    sites: Sites
    shape: tuple[int, int]
    iso: float | None
    frames: tuple[int, int]
    fit: Fitted = field(default_factory=Fitted)
    repeats: tuple[int, ...] = ()
    tails: Tails | None = None
    structure: BiasStructure | None = None
    dark: DarkCurrent | None = None
    spread: DarkSpread | None = None
    glow: Glow | None = None
    transfer: PhotonTransfer | None = None
    light: Light | None = None
    linearity: Linearity | None = None
    lamp: Measured | None = None
    offset: Map | None = field(default=None, repr=False)
    rate: Map | None = field(default=None, repr=False)
    response: Map | None = field(default=None, repr=False)
    transients: tuple[Transients, ...] = ()
    notes: tuple[str, ...] = ()
    clipped: int = 0
    faint: int = 0
    excluded: Mapping[str, str] = field(default_factory=dict)
    defects: Defects = field(default_factory=Defects, repr=False)

    def figure(self, name: str) -> Measured | None:
        """Return a figure with its standard error, the mean of all sites; None if it is
        missing. name : as in the table."""
        return of_all(self.fit.figures, name)

    def each(self, name: str) -> tuple[Measured, ...]:
        """Return a figure of each site; nothing if it is missing."""
        return of_sites(self.fit.figures, name)

    @property
    def black(self) -> NDArray[np.float64]:
        """(sites,) DN: as measured, else the profile's."""
        found = [one.value for one in self.each("black level")]
        return np.array(found or self.sensor.black_level, float)

    @property
    def range(self) -> float:
        """White above black, DN, mean of all sites: the unit of a signal."""
        return self.sensor.white_level - float(self.black.mean())

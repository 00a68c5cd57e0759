# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Measurements: all that darks and flats show of a sensor, each with its error."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cg2raw.calibration.darks import DarkResults
from cg2raw.calibration.defects import Defects
from cg2raw.calibration.fitting import Fitted, of_all, of_sites
from cg2raw.calibration.flats import FlatResults
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.sites import Sites
from cg2raw.sensor import Sensor


@dataclass(frozen=True, kw_only=True)
class Measurements(DarkResults, FlatResults):
    """What frames of uniform light and of none show; None where they cannot, and why
    is in the notes.

    sensor : whose profile was given. iso : of the frames, None if nobody says it.
    shape : (H, W) px. frames : (darks, flats). fit : figures by one likelihood, and why
    darks do not show all of them. repeats : how many of the shortest darks repeat each
    other, group by group. excluded : {name of a frame that is none of its repeats: how
    it is off}. transients : {group: how many pixels of single frames are far off their
    repeats, by cosmic rays or flicker}."""

    sensor: Sensor
    sites: Sites
    shape: tuple[int, int]
    iso: float | None
    frames: tuple[int, int]
    fit: Fitted = field(default_factory=Fitted)
    repeats: tuple[int, ...] = ()
    transients: Mapping[str, int] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
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

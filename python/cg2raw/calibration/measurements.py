# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Measurements: all that darks and flats show of a sensor, each with its error."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cg2raw.calibration.black import BiasStructure, Drift
from cg2raw.calibration.dark_current import DarkCurrent
from cg2raw.calibration.dark_maps import DarkMaps
from cg2raw.calibration.dark_spread import DarkSpread
from cg2raw.calibration.defects import Defects
from cg2raw.calibration.glow import Glow
from cg2raw.calibration.light import Light, Linearity
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.photon_transfer import PhotonTransfer
from cg2raw.calibration.sites import Sites
from cg2raw.calibration.temporal_noise import TemporalNoise
from cg2raw.model.figures import Figure
from cg2raw.sensor import Sensor


def measured_in(figures: Sequence[Figure], name: str) -> Measured | None:
    """Return a figure of all planes with its standard error; None if it is missing."""
    for one in figures:
        if one.name == name:
            return Measured(one.value, float(one.standard_error), one.unit)
    return None


@dataclass(frozen=True)
class Transients:
    """Pixels of single frames far above their repeats: cosmic rays, or flicker."""

    group: str
    count: int
    frames: int


Lost = Literal["", "cut", "coarse"]


@dataclass(frozen=True)
class Measurements:
    """What frames of uniform light and of none show; None where they cannot, and why
    is in the notes.

    sensor : whose profile was given. iso : of the frames, None if nobody says it.
    shape : (H, W) px. frames : (darks, flats). black_level : (sites) DN.
    drift : DN, standard deviation of the level from frame to frame.
    lamp : relative, standard deviation of the flats' light. maps : of each pixel.
    lost : why darks do not show their noise: it is cut at the lowest code, or codes are
    too coarse for it. few_codes : DN, of coarse ones, the deviation of the normal
    distribution that has their shares, fixed patterns included. clipped : number of
    flats that show saturation alone. faint : of flats whose noise is rounding's.
    excluded : {name of a frame that is none of its repeats: how it is off}.
    figures : of all frames by one likelihood, with 95 % intervals."""

    sensor: Sensor
    sites: Sites
    shape: tuple[int, int]
    iso: float | None
    frames: tuple[int, int]
    black_level: tuple[Measured, ...] | None = None
    drift: Drift | None = None
    structure: BiasStructure | None = None
    noise: TemporalNoise | None = None
    dark: DarkCurrent | None = None
    spread: DarkSpread | None = None
    glow: Glow | None = None
    transfer: PhotonTransfer | None = None
    light: Light | None = None
    linearity: Linearity | None = None
    lamp: Measured | None = None
    maps: DarkMaps | None = field(default=None, repr=False)
    transients: tuple[Transients, ...] = ()
    notes: tuple[str, ...] = ()
    lost: Lost = ""
    few_codes: Measured | None = None
    clipped: int = 0
    faint: int = 0
    excluded: Mapping[str, str] = field(default_factory=dict)
    defects: Defects = field(default_factory=Defects, repr=False)
    figures: Sequence[Figure] = ()

    @property
    def black(self) -> NDArray[np.float64]:
        """(sites,) DN: as measured, else the profile's."""
        if self.black_level is None:
            return np.array(self.sensor.black_level)
        return np.array([m.value for m in self.black_level])

    @property
    def read_variance(self) -> tuple[Measured, ...] | None:
        """(sites,) DN^2 without rounding, of the darks; else, where these have lost it,
        of the flats' line; None if neither shows it."""
        rounding = self.sites.rounding
        if self.few_codes is not None:
            return (self.few_codes.squared,) * self.sites.count
        if self.noise is not None:
            squares = tuple(m.squared for m in self.noise.read_noise)
        elif self.lost and self.transfer is not None:
            squares = self.transfer.intercept
            if self.lost == "cut" and not all(s.stands_out for s in squares):
                return None
        else:
            return None
        return tuple(replace(s, value=s.value - rounding) for s in squares)

    def figure(self, name: str) -> Measured | None:
        """Return a figure of all planes with its standard error; None if it is
        missing."""
        return measured_in(self.figures, name)

    @property
    def range(self) -> float:
        """White above black, DN, mean of all sites: the unit of a signal."""
        return self.sensor.white_level - float(self.black.mean())

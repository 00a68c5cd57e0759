# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Photon transfer: variance against mean in blocks of the field, and where it ends.

Source: EMVA Standard 1288, release 4.0, sections on system gain and saturation
capacity; J. R. Janesick, Photon Transfer, 2007."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cg2raw.calibration.measured import SIGNIFICANT, Measured
from cg2raw.calibration.robust import LEAST_SIGMA, Array, clipped_moments
from cg2raw.calibration.seen import Seen
from cg2raw.calibration.sites import blocks_of
from cg2raw.statistics.codes import COARSE

CEILING = 0.5  # of the largest variance of darker flats; below it the well is full
CERTAIN = 4.0  # standard errors that a block's variance is below it
MOST_CLIPPED = 0.002  # of the pixels of a flat that still counts (EMVA 1288)
MANY = 0.2  # of the pixels at one DN, which noise spreads over several
RISING = 1.2  # levels of flats whose wells are full are closer than by this


@dataclass(frozen=True)
class TransferPoints:
    """Of one group of flats, (sites, blocks): mean above black, variance of a frame,
    both DN, and the relative error of the variance."""

    mean: Array
    variance: Array
    error: Array
    level: float  # DN above black, of the whole frame
    exposure_time: float | None
    frames: int
    clipped: float  # share of pixels at white, at 0 DN, or in blocks that are full
    is_coarse: bool  # rounding makes up so much of the variance that it is not known

    @property
    def is_clipped(self) -> bool:
        """Whether so many pixels are clipped that the others' mean is not that of all:
        such a flat shows saturation alone."""
        return self.clipped > MOST_CLIPPED

    @property
    def is_right(self) -> bool:
        """Whether mean and variance are those of light."""
        return not self.is_clipped and not self.is_coarse

    def above(self, black: Array) -> "TransferPoints":
        """Return the points above another level, (sites,) DN higher."""
        mean, level = self.mean - black[:, None], self.level - float(black.mean())
        return replace(self, mean=mean, level=level)


@dataclass(frozen=True)
class PhotonTransfer:
    """points : of the groups of flats. saturation : DN above black, of the full well or
    of the converter; None if no frame reaches it. clipped_by : "full well" or "white
    level" then."""

    points: tuple[TransferPoints, ...]
    saturation: Measured | None
    clipped_by: str


def transfer_points(
    seen: Seen, number: int, black: Array, darker: Sequence[TransferPoints]
) -> TransferPoints:
    """Return mean and variance in blocks of the field: each block is nearly uniform,
    however the light falls off. black : (sites,) DN, dark signal included.

    darker : points of darker flats, which tell where wells are full."""
    (variance, error), image = seen.noise(number), seen.mean_of(number)
    sites = seen.sites
    frames = int(seen.statistics.frames[number])
    means, levels, least = [], [], LEAST_SIGMA * sites.step
    kept = sites.of(seen.known(image))
    for plane, used, level in zip(sites.of(image), kept, black, strict=True):
        if used.any():
            levels.append(float(plane[used].mean(dtype=np.float64)) - level)
        for block, mask in zip(blocks_of(plane), blocks_of(used), strict=True):
            inside = block[mask]
            some = inside.size > 8
            middle = clipped_moments(inside, least)[0] if some else level
            means.append(middle - level)
    mean = np.reshape(means, variance.shape)
    largest = np.max([p.variance for p in darker], axis=0) if darker else 0.0
    full = variance * (1 + CERTAIN * error) < CEILING * largest
    return TransferPoints(
        mean,
        variance,
        error,
        float(np.mean(levels)),
        seen.groups[number].exposure_time,
        frames,
        max(seen.clipped(number), float(np.average(full, weights=error**-2))),
        float(np.median(variance)) < COARSE * sites.step**2,
    )


def at_white(
    seen: Seen, number: int, black: Array, highest: int
) -> tuple[Measured, str] | None:
    """Return (saturation above black in DN, "white level") of flats with one DN in many
    of their pixels, else None.

    highest : DN, of all flats: what has few codes below it is quiet, not clipped."""
    frames = seen.groups[number].frames
    top = max(scanned.highest for scanned in frames)
    at_top = float(np.mean([scanned.at_highest for scanned in frames]))
    saturated = float(np.mean([scanned.saturated for scanned in frames]))
    if max(at_top * (top == highest), saturated) <= MANY:
        return None
    level = min(top, seen.white) - float(black.mean())
    return Measured(level, 0.5, "DN"), "white level"


def full_well(
    points: Sequence[TransferPoints], levels: Array
) -> tuple[Measured, str] | None:
    """Return (saturation above black in DN, "full well") if the last of the points, of
    frames of @levels, DN, has reached it; else None.

    points : from dark to bright. The well is full where more light brings less noise:
    where the variance falls below half of that of darker flats."""
    variances = [float(np.median(p.variance)) for p in points]
    if len(points) > 1 and variances[-1] < CEILING * max(variances[:-1]):
        error = max(float(np.std(levels)), 0.1 * math.sqrt(variances[-1]))
        return Measured(points[-1].level, error, "DN"), "full well"
    return None


def check_curve(points: Sequence[TransferPoints], seen: Seen, is_cut: bool) -> None:
    """Raise ValueError for flats of codes that follow a curve of light.

    Photons' variance over level is the system gain, or less where wells are full and
    levels rise no more. By a square root of light it falls all along.
    is_cut : of darks' noise, which then is not known."""
    repeated = [number for number in seen.shortest if seen.repeats(number)]
    if is_cut or not repeated:
        return
    for site, dark in enumerate(seen.statistics.variance(repeated[0])):
        least, most = dark, dark
        if seen.is_coarse(repeated[0]):
            least, most = seen.sites.rounding, COARSE * seen.sites.step**2
        steepest, behind = 0.0, []
        for p in points:
            if p.is_coarse:
                continue
            level, variance = (float(np.median(x[site])) for x in (p.mean, p.variance))
            of_median = 1.25 * np.median(p.error[site]) / math.sqrt(p.mean[site].size)
            error = SIGNIFICANT * variance * float(of_median)
            if (variance - least + error) / level < CEILING * steepest:
                behind.append(level)
            steepest = max(steepest, (variance - most - error) / level)
        if behind and max(behind) > RISING * min(behind):
            raise ValueError(
                f"flats: from {min(behind):.0f} DN above black on, noise is less than "
                f"half of what light brings, and levels rise to {max(behind):.0f} DN: "
                "codes follow a curve of light (companded, as by a square root or in "
                "pieces): linearize them by the camera's table, or give linear RAW"
            )

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Photon transfer: system gain from variance against mean, and where it ends.

Source: EMVA Standard 1288, release 4.0, sections on system gain (the slope from 0 to
70 % of saturation) and saturation capacity; J. R. Janesick, Photon Transfer, 2007.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cg2raw.calibration.frames import Group
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.repeats import Repeats
from cg2raw.calibration.robust import LEAST_SIGMA, Array, clipped_moments
from cg2raw.calibration.sites import Sites, blocks_of
from cg2raw.statistics.codes import COARSE, wave_of_rounding

LINEAR = 0.7  # of saturation, up to which the slope is taken
CEILING = 0.5  # of the largest variance of darker flats; below it the well is full
CERTAIN = 4.0  # standard errors that a block's variance is below it
MOST_CLIPPED = 0.002  # of the pixels of a flat that still counts (EMVA 1288)
MANY = 0.2  # of the pixels at one DN, which noise spreads over several


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


@dataclass(frozen=True)
class PhotonTransfer:
    """What photon transfer shows.

    system_gain : (sites) DN per electron. intercept : (sites) DN^2, variance without
    light, rounding included, by darks and the line itself.
    saturation : DN, level of the full well or of the converter; None if no frame
    reaches it. clipped_by : "full well" or "white level" then.
    chi2 : of the points about the line, per degree of freedom."""

    system_gain: tuple[Measured, ...]
    intercept: tuple[Measured, ...]
    points: tuple[TransferPoints, ...]
    chi2: float
    saturation: Measured | None
    clipped_by: str

    @property
    def mean_gain(self) -> Measured:
        """Electrons per DN, of all sites together."""
        values = np.array([m.value for m in self.system_gain])
        errors = np.array([max(m.standard_error, 1e-30) for m in self.system_gain])
        weight = 1 / errors**2
        mean = float((values * weight).sum() / weight.sum())
        error = 1 / math.sqrt(float(weight.sum()))
        return Measured(1 / mean, error / mean**2, "e-/DN")


def transfer_points(
    flats: Repeats, sites: Sites, black: Array, darker: Sequence[TransferPoints]
) -> TransferPoints:
    """Return mean and variance in blocks of the field: each block is nearly uniform,
    however the light falls off. black : (sites,) DN, dark signal included.

    darker : points of darker flats, which tell where wells are full."""
    noise = flats.noise
    assert noise is not None
    means, spreads, levels, least = [], [], [], LEAST_SIGMA * sites.step
    kept = sites.of(flats.known)
    for plane, used, level in zip(sites.of(flats.mean), kept, black, strict=True):
        if used.any():
            levels.append(float(plane[used].mean(dtype=np.float64)) - level)
        for block, mask in zip(blocks_of(plane), blocks_of(used), strict=True):
            inside = block[mask]
            some = inside.size > 8
            middle, sigma, _ = clipped_moments(inside, least) if some else (level, 0, 0)
            means.append(middle - level)
            spreads.append(sigma**2)
    mean = np.reshape(means, noise.variance.shape)
    steps = sites.step**2
    spread = np.reshape(spreads, mean.shape) - noise.variance / flats.count
    dn = mean + np.reshape(black, (-1, 1))
    variance = noise.variance - steps * wave_of_rounding(
        noise.variance / steps, dn / sites.step, np.maximum(spread, 0) / steps
    )
    error = np.array(
        [relative_error(max(n, 1), flats.pairs) for n in noise.pixels.ravel()]
    )
    error = error.reshape(mean.shape)
    largest = np.max([p.variance for p in darker], axis=0) if darker else 0.0
    full = noise.variance * (1 + CERTAIN * error) < CEILING * largest
    share = float(noise.pixels[full].sum() / max(noise.pixels.sum(), 1))
    return TransferPoints(
        mean,
        variance,
        error,
        float(np.mean(levels)),
        flats.group.exposure_time,
        flats.count,
        max(flats.clipped, share),
        float(np.median(variance)) < COARSE * steps,
    )


def relative_error(pixels: float, pairs: int) -> float:
    """Return the standard error of a variance over it, of normal noise.

    pairs : of frames that no other pair has."""
    return math.sqrt(2 / (pixels * pairs))


def photon_transfer(
    points: Sequence[TransferPoints],
    dark_variance: Sequence[Measured] | None,
    white: float,
    ceiling: tuple[Measured, str] | None,
) -> PhotonTransfer | None:
    """Return the line of variance against mean; None if no flat can show it.

    dark_variance : (sites) DN^2, of darks of the flats' exposure; None: the line alone
    shows it, which needs two levels. white : DN above black.
    ceiling : saturation above black, DN, and what clips there."""
    most = LINEAR * (ceiling[0].value if ceiling else white)
    used = [p for p in points if p.level <= most and p.is_right]
    levels = np.array([p.level for p in used])
    if not used or (dark_variance is None and np.ptp(levels) < 0.2 * levels.max()):
        return None
    gains, intercepts, chi2 = [], [], []
    for site in range(used[0].mean.shape[0]):
        mean, variance, error = (
            np.concatenate([getattr(p, name)[site] for p in used])
            for name in ("mean", "variance", "error")
        )
        dark = None if dark_variance is None else dark_variance[site]
        gain, intercept, misfit = _slope(mean, variance, error, dark)
        gains.append(gain)
        intercepts.append(intercept)
        chi2.append(misfit)
    return PhotonTransfer(
        tuple(gains),
        tuple(intercepts),
        tuple(points),
        float(np.mean(chi2)),
        ceiling[0] if ceiling else None,
        ceiling[1] if ceiling else "",
    )


def _slope(
    mean: Array, variance: Array, error: Array, dark: Measured | None
) -> tuple[Measured, Measured, float]:
    """Return (system gain, intercept, chi-square per freedom) of one site.

    dark : the intercept, as far as it is known without the points."""
    design = np.stack([mean, np.ones_like(mean)], 1)
    prior, known = np.zeros((0, 2)), np.zeros(0)
    if dark is not None:
        certainty = 1 / max(dark.standard_error, 1e-9)
        prior, known = np.array([[0.0, certainty]]), np.array([dark.value * certainty])
    model, keep, widened = variance, mean > 0, 1.0
    for _ in range(3):  # weights of the fitted variance, not of the measured one
        weight = np.where(keep, 1 / np.maximum(error * model, 1e-9), 0)
        scaled = np.concatenate([design * weight[:, None], prior * math.sqrt(widened)])
        target = np.concatenate([variance * weight, known * math.sqrt(widened)])
        values = np.linalg.lstsq(scaled, target, rcond=None)[0]
        model = np.maximum(design @ values, 1e-9)
        z = (variance - design @ values) * weight
        keep &= np.abs(z) <= 6 * max(clipped_moments(z[keep])[1], 1.0)
        freedom = max(int(keep.sum()) - 2 + len(known), 1)
        chi2 = float((z[keep] ** 2).sum()) / freedom
        widened = max(chi2, 1.0)  # of the points alone: darks are not less certain
    errors = np.sqrt(np.diag(np.linalg.pinv(scaled.T @ scaled)) * widened)
    gain, intercept = map(float, values)
    return (
        Measured(gain, float(errors[0]), "DN/e-"),
        Measured(intercept, float(errors[1]), "DN^2"),
        chi2,
    )


def at_white(
    group: Group, white: int, black: Array, highest: int
) -> tuple[Measured, str] | None:
    """Return (saturation above black in DN, "white level") of flats with one DN in many
    of their pixels, else None.

    highest : DN, of all flats: what has few codes below it is quiet, not clipped."""
    top = max(scanned.highest for scanned in group.frames)
    at_top = float(np.mean([scanned.at_highest for scanned in group.frames]))
    saturated = float(np.mean([scanned.saturated for scanned in group.frames]))
    if max(at_top * (top == highest), saturated) <= MANY:
        return None
    return Measured(min(top, white) - float(black.mean()), 0.5, "DN"), "white level"


def full_well(
    points: Sequence[TransferPoints], black: Array, group: Group
) -> tuple[Measured, str] | None:
    """Return (saturation above black in DN, "full well") if the last of the points,
    those of @group, has reached it; else None.

    points : from dark to bright. The well is full where more light brings less noise:
    where the variance falls below half of that of darker flats."""
    variances = [float(np.median(p.variance)) for p in points]
    if len(points) > 1 and variances[-1] < CEILING * max(variances[:-1]):
        levels = [scanned.mean_level for scanned in group.frames]
        noise = math.sqrt(variances[-1])
        error = max(float(np.std(levels)), 0.1 * noise)
        return Measured(points[-1].level, error, "DN"), "full well"
    return None

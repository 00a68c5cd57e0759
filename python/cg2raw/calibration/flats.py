# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Flats: their groups are read by level, and what they show above the darks."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from cg2raw.calibration.darks import DarkResults, words_of
from cg2raw.calibration.frames import Group
from cg2raw.calibration.light import Light, Linearity, lamp_drift, light_of, linearity
from cg2raw.calibration.measured import SIGNIFICANT, Measured
from cg2raw.calibration.measurements import Transients
from cg2raw.calibration.photon_transfer import (
    CEILING,
    PhotonTransfer,
    TransferPoints,
    at_white,
    full_well,
    photon_transfer,
    transfer_points,
)
from cg2raw.calibration.repeats import Repeats, Seen, Todo
from cg2raw.calibration.robust import Array
from cg2raw.calibration.sites import Sites
from cg2raw.sensor import Sensor
from cg2raw.statistics.codes import COARSE

RISING = 1.2  # levels of flats whose wells are full are closer than by this


@dataclass(frozen=True)
class FlatResults:
    """What flats show; see Calibration."""

    transfer: PhotonTransfer | None = None
    light: Light | None = None
    linearity: Linearity | None = None
    lamp: Measured | None = None
    clipped: int = 0
    faint: int = 0


@dataclass
class Flats:
    """What is kept of the groups of flats; of the brightest that is not clipped, all.

    groups : those that are not clipped. clipped : frames that are.
    first_gain : DN per electron, roughly, before darks are known."""

    groups: Sequence[Group]
    points: list[TransferPoints]
    transients: list[Transients]
    best: Repeats | None = None
    first_gain: float | None = None
    ceiling: tuple[Measured, str] | None = None
    clipped: int = 0


def read_flats(
    seen: Seen,
    first: int,
    levels: Array,
    tell: Callable[[float], None],
) -> Flats:
    """Return what is needed of flats, group by group from dark to bright.

    first : number of the darkest, whose groups are the last.
    levels : (sites,) DN of black, of the shortest darks or the profile."""
    found, todo = Flats([], [], []), seen.todo
    order = seen.groups[first:]
    top = max((s.highest for group in order for s in group.frames), default=0)
    for index, group in enumerate(order):
        if float((group.level - levels).min()) <= 0:
            raise ValueError(
                f"{group.frames[0].frame.name}: a flat of {group.level.mean():.1f} DN, "
                f"black is {levels.mean():.1f} DN: is it a dark? Give it among --darks"
            )
        repeats = seen.repeats(first + index)
        ceiling = at_white(group, todo.white, levels, top)
        found.ceiling = found.ceiling or ceiling
        if repeats.noise is None and ceiling:
            found.clipped += repeats.count
        elif repeats.noise is not None:
            take_up(found, repeats, todo, levels)
        tell((index + 1) / len(order))
    return found


def take_up(found: Flats, repeats: Repeats, todo: Todo, black: Array) -> None:
    """Add a group of flats that is brighter than those before."""
    group = repeats.group
    point = transfer_points(repeats, todo.sites, black, found.points)
    found.points.append(point)
    found.transients.append(
        Transients(words_of(group), repeats.transients or 0, repeats.count)
    )
    found.ceiling = found.ceiling or full_well(found.points, black, group)
    if found.ceiling or point.is_clipped:
        found.clipped += repeats.count
        return
    found.groups = [*found.groups, group]
    if point.is_coarse:
        return
    found.best = repeats
    found.first_gain = float(np.median(point.variance / np.maximum(point.mean, 1)))


def above_darks(
    flats: Flats,
    darks: DarkResults,
    sensor: Sensor,
    sites: Sites,
    iso: float | None,
) -> FlatResults:
    """Return what flats show once the darks are known. Raises ValueError for codes that
    are no light."""
    if not flats.points:
        return FlatResults()
    check_curve(flats.points, darks, sites)
    rate = darks.dark.rate.value if darks.dark else 0.0
    points = [
        replace(
            p,
            mean=p.mean - rate * (p.exposure_time or 0.0),
            level=p.level - rate * (p.exposure_time or 0.0),
        )
        for p in flats.points
    ]
    black = np.mean(
        [m.value for m in darks.black_level]
        if darks.black_level
        else sensor.black_level
    )
    white = sensor.white_level - float(black)
    lamp = lamp_drift(flats.groups, float(black))
    top = flats.ceiling[0].value if flats.ceiling else white
    return FlatResults(
        photon_transfer(
            points,
            dark_variance(darks, sensor, sites, iso, points),
            white,
            flats.ceiling,
        ),
        response(flats, darks, sensor, sites),
        linearity(points, top, lamp.value if lamp else 0.0, white),
        lamp,
        flats.clipped,
        sum(p.frames for p in points if p.is_coarse),
    )


def check_curve(
    points: Sequence[TransferPoints], darks: DarkResults, sites: Sites
) -> None:
    """Raise ValueError for flats of codes that follow a curve of light.

    Photons' variance over level is the system gain, or less where wells are full and
    levels rise no more. By a square root of light it falls all along."""
    if darks.noise is None and darks.lost != "coarse":
        return
    for site in range(sites.count):
        least, most = sites.rounding, COARSE * sites.step**2
        if darks.noise is not None:
            least = most = darks.noise.read_noise[site].value ** 2
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


def dark_variance(
    darks: DarkResults,
    sensor: Sensor,
    sites: Sites,
    iso: float | None,
    points: Sequence[TransferPoints],
) -> list[Measured] | None:
    """Return (sites) DN^2 of a pixel without light: of the darks, which codes that are
    too coarse show within limits; else, for flats of one level, of the profile's noise;
    else None, and the line's intercept counts."""
    if darks.noise is not None:
        return [m.squared for m in darks.noise.read_noise]
    if darks.lost == "coarse":
        low, high = sites.rounding, COARSE * sites.step**2
        even = Measured((low + high) / 2, (high - low) / math.sqrt(12), "DN^2")
        return [even] * sites.count
    levels = [p.level for p in points]
    if iso is None or not sensor.noise or max(levels) > 1.2 * min(levels):
        return None
    square = (sensor.white_level - float(np.mean(sensor.black_level))) ** 2
    betas = np.broadcast_to(sensor.noise_at(iso)["beta2"], sites.count)
    return [Measured(float(b) * square, 0.1 * float(b) * square, "DN^2") for b in betas]


def response(
    flats: Flats, darks: DarkResults, sensor: Sensor, sites: Sites
) -> Light | None:
    """Return PRNU and shading of the brightest flats that are not clipped."""
    best = flats.best
    if best is None or best.noise is None:
        return None
    mean, known = np.array(best.mean), np.array(best.known)
    temporal = float(best.noise.site_variance.mean()) / best.count
    if darks.maps is None:
        mean -= sites.spread(sensor.black_level, mean.shape)
    else:
        time = best.group.exposure_time or 0.0
        mean -= darks.maps.offset
        powers = np.array([1.0, time])
        if darks.maps.rate is not None:
            mean -= darks.maps.rate * np.float32(time)
        known &= darks.maps.known
        temporal += float(powers @ darks.maps.covariance @ powers)
    return light_of(mean, known, sites, temporal, best.count)

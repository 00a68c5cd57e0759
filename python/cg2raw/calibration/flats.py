# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Flats: which show a gain, and what they show above the darks."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from cg2raw.calibration.darks import DarkResults, Map
from cg2raw.calibration.light import Light, Linearity, lamp_drift, light_of, linearity
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.photon_transfer import (
    PhotonTransfer,
    TransferPoints,
    at_white,
    full_well,
    transfer_points,
)
from cg2raw.calibration.robust import Array
from cg2raw.calibration.seen import Seen

# Of saturation, up to which flats show a gain. Source: EMVA 1288, release 4.0.
LINEAR = 0.7


@dataclass(frozen=True, kw_only=True)
class FlatResults:
    """What flats show. response : (H, W) of each pixel, relative. lamp : relative,
    standard deviation of their light. clipped : number of frames that show saturation
    alone. faint : of those whose noise is rounding's."""

    transfer: PhotonTransfer | None = None
    light: Light | None = None
    response: Map | None = field(default=None, repr=False)
    linearity: Linearity | None = None
    lamp: Measured | None = None
    clipped: int = 0
    faint: int = 0


@dataclass
class Flats:
    """What is kept of the groups of flats: points of those that repeat each other.

    used : numbers of those whose noise is light's and that are not clipped. full : of
    the darkest that is clipped, if wells are full. ceiling : where flats clip, DN above
    black, and by what. clipped : frames that are."""

    points: list[TransferPoints] = field(default_factory=list)
    used: list[int] = field(default_factory=list)
    full: int | None = None
    ceiling: tuple[Measured, str] | None = None
    clipped: int = 0

    def linear(self, seen: Seen, levels: Array) -> list[int]:
        """Return numbers of flats up to LINEAR of saturation."""
        white = seen.sensor.white_level - float(levels.mean())
        most = LINEAR * (self.ceiling[0].value if self.ceiling else white)
        level = float(levels.mean())
        return [n for n in self.used if float(seen.levels(n).mean()) - level <= most]


def read_flats(seen: Seen, levels: Array, tell: Callable[[float], None]) -> Flats:
    """Return what is needed of flats, group by group from dark to bright.

    levels : (sites,) DN of black, of the shortest darks or the profile."""
    found, first = Flats(), len(seen.darks)
    order = seen.groups[first:]
    top = max((s.highest for group in order for s in group.frames), default=0)
    for number, group in enumerate(order, first):
        if float((group.level - levels).min()) <= 0:
            raise ValueError(
                f"{group.frames[0].frame.name}: a flat of {group.level.mean():.1f} DN, "
                f"black is {levels.mean():.1f} DN: is it a dark? Give it among --darks"
            )
        ceiling = at_white(seen, number, levels, top)
        found.ceiling = found.ceiling or ceiling
        if seen.repeats(number):
            take_up(found, seen, number, levels)
        elif ceiling:
            found.clipped += len(group.frames)
        tell((number + 1 - first) / len(order))
    if found.ceiling is not None and found.ceiling[1] == "full well":
        found.full = max(found.used, default=first - 1) + 1
    return found


def take_up(found: Flats, seen: Seen, number: int, black: Array) -> None:
    """Add a group of flats that is brighter than those before."""
    point = transfer_points(seen, number, black, found.points)
    found.points.append(point)
    found.ceiling = found.ceiling or full_well(found.points, seen.levels(number))
    if found.ceiling or point.is_clipped:
        found.clipped += point.frames
        return
    if not point.is_coarse:
        found.used.append(number)


def above_darks(
    seen: Seen,
    flats: Flats,
    darks: DarkResults,
    levels: Array,
    black: NDArray[np.float64],
) -> FlatResults:
    """Return what flats show once the darks are known.

    levels, black : (sites,) DN, by which flats were read, and as it is known now."""
    if not flats.points:
        return FlatResults(clipped=flats.clipped)
    rate = darks.dark.rate.value if darks.dark else 0.0
    points = [
        p.above(black - levels + rate * (p.exposure_time or 0.0)) for p in flats.points
    ]
    white = seen.sensor.white_level - float(black.mean())
    ceiling, by = flats.ceiling or (None, "")
    if ceiling is not None:
        moved = float((levels - black).mean())
        ceiling = replace(ceiling, value=ceiling.value + moved)
    lamp = lamp_drift([seen.levels(n) - black.mean() for n in flats.used])
    light, response = None, None
    if flats.used:
        best = flats.used[-1]
        response = seen.mean_of(best)
        known = seen.known(response)
        response -= above_black(seen, best, darks, black)
        light = light_of(response, known, seen, best)
    top = ceiling.value if ceiling is not None else white
    return FlatResults(
        transfer=PhotonTransfer(tuple(points), ceiling, by),
        light=light,
        response=response,
        linearity=linearity(points, top, lamp.value if lamp else 0.0, white),
        lamp=lamp,
        clipped=flats.clipped,
        faint=sum(p.frames for p in points if p.is_coarse),
    )


def above_black(
    seen: Seen, number: int, darks: DarkResults, black: NDArray[np.float64]
) -> Map:
    """Return (H, W) DN, what pixels of a flat have without light."""
    height, width = seen.groups[number].frames[0].shape
    found = seen.sites.spread(black, (height, width))
    if darks.offset is not None:
        found += darks.offset
    if darks.rate is not None:
        since = seen.time(number) - seen.time(seen.shortest[0])
        found += darks.rate * np.float32(since)
    return found

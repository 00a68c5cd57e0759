# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Flats: which show a gain, and what all show above the darks: shading, linearity, the
lamp's drift.

Source: EMVA Standard 1288, release 4.0, section on linearity; D. B. Goldman, IEEE
Trans. PAMI 32(12), 2010 (the shading's polynomial)."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from cg2raw.calibration.darks import DarkResults, Map
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.photon_transfer import (
    PhotonTransfer,
    TransferPoints,
    at_white,
    full_well,
    transfer_points,
)
from cg2raw.calibration.robust import Array, clipped_moments, linear_fit
from cg2raw.calibration.seen import Seen
from cg2raw.calibration.sites import FIELD_BLOCKS, Sites, blocks_of, centres

# Of saturation, up to which flats show a gain. Source: EMVA 1288, release 4.0.
LINEAR = 0.7
SHADING = ("r2", "r4", "r6", "tilt_x", "tilt_y", "tilt_x_r2", "tilt_y_r2")
LOWEST, HIGHEST = 0.05, 0.95  # of saturation, between which linearity is judged
FEWEST_LEVELS = 3


@dataclass(frozen=True)
class Light:
    """Response to uniform light.

    shading : {coefficient: value}, of lens_shading. fall_off : relative, rms of that
    shading over the field. residual : relative, rms of what it leaves of the map.
    field : (blocks, blocks) relative response. noise : relative variance of a pixel of
    the mean flat by temporal noise."""

    shading: dict[str, Measured]
    fall_off: Measured
    residual: float
    field: Array
    noise: float


@dataclass(frozen=True)
class Linearity:
    """Level against exposure time under one lamp.

    error : %, mean absolute deviation from the line with an offset, of the level (EMVA
    1288). quadratic, cubic : loss at white, of nonlinearity; cubic None where it does
    not stand out. bend : relative, mean absolute deviation from a line through zero,
    which these describe. exposures : s; levels : DN above black; deviations : %."""

    error: Measured
    quadratic: Measured
    cubic: Measured | None
    bend: float
    exposures: Array
    levels: Array
    deviations: Array


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
        light, response = light_of(seen, flats.used[-1:], black, darks)
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


def light_of(
    seen: Seen, numbers: Sequence[int], black: Array, darks: DarkResults
) -> tuple[Light, Map]:
    """Return the response of the mean of groups of flats of one level, and its map, in
    which each site's median is 1, and what is not known. numbers : of the groups.
    black : (sites,) DN."""
    mean = seen.mean_over(numbers)
    known = seen.known(mean)
    mean -= seen.sites.spread(black, mean.shape)
    if darks.offset is not None:
        mean -= darks.offset
    if darks.rate is not None:
        since = seen.time(numbers[0]) - seen.time(seen.shortest[0])
        mean -= darks.rate * np.float32(since)
    sites, frames = seen.sites, seen.statistics.frames[numbers].sum()
    noise, relative = seen.statistics.variance(numbers[0]), []
    pairs = zip(sites.of(mean), sites.of(known), noise, strict=True)
    for plane, used, variance in pairs:
        level = float(np.median(plane[used]))
        plane /= np.float32(level)
        relative.append(variance / level**2 / frames)
    shading, field, fall_off, residual = field_of(mean, known, sites)
    mean[~known] = 1
    return Light(shading, fall_off, residual, field, float(np.mean(relative))), mean


def field_of(
    response: Array, known: Array, sites: Sites
) -> tuple[dict[str, Measured], Array, Measured, float]:
    """Return (shading's coefficients, map, rms of the shading, rms of the rest).

    response : (H, W), relative, each site's median at 1, where it is known. Means of
    blocks of all pixels are fitted by least squares; dust is what they have besides.
    A block without a known pixel has the fit's value."""
    across = min(FIELD_BLOCKS, *(side // (4 * sites.side) for side in response.shape))
    maps = []
    for plane, used in zip(sites.of(response), sites.of(known), strict=True):
        blocks = zip(blocks_of(plane, across), blocks_of(used, across), strict=True)
        means = [clipped_moments(b[u])[0] if u.any() else np.nan for b, u in blocks]
        maps.append(np.reshape(means, (across, across)))
    field: Array = np.mean(maps, axis=0)
    height, width = response.shape
    half = math.hypot(height, width) / 2
    v, u = np.meshgrid(
        (centres(height, across, sites.side) - height / 2) / half,
        (centres(width, across, sites.side) - width / 2) / half,
        indexing="ij",
    )
    square = u**2 + v**2
    terms = (square, square**2, square**3, u, v, square * u, square * v)
    design = np.stack([t.ravel() for t in (np.ones_like(u), *terms)], 1)
    filled = np.isfinite(field.ravel())
    fit = linear_fit(design[filled], field.ravel()[filled])
    values, said = fit.values, design @ fit.values
    field = np.where(filled, field.ravel(), said).reshape(field.shape)
    errors = np.sqrt(np.diag(fit.covariance)) / values[0]
    shading = {
        name: Measured(float(value / values[0]), float(error), "1")
        for name, value, error in zip(SHADING, values[1:], errors[1:], strict=True)
    }
    shape = design[:, 1:] @ values[1:] / values[0]
    rms = float(np.std(shape))
    fall_off = Measured(rms, math.sqrt(fit.variance * 8 / field.size), "1")
    return shading, field, fall_off, float(np.std(fit.rest))


def lamp_drift(groups: Sequence[Array]) -> Measured | None:
    """Return the relative standard deviation of the lamp from flat to flat; None if no
    two flats repeat each other. groups : of each, (frames,) DN above black."""
    freedom = sum(len(levels) - 1 for levels in groups)
    if not freedom:
        return None
    rests = [levels / levels.mean() - 1 for levels in groups]
    value = math.sqrt(sum(float(rest @ rest) for rest in rests) / freedom)
    return Measured(value, value / math.sqrt(2 * freedom), "1")


def linearity(
    points: Sequence[TransferPoints], ceiling: float, lamp: float, white: float
) -> Linearity | None:
    """Return how level follows exposure time; None of fewer than three exposures.

    ceiling : saturation, DN above black. lamp : relative drift from flat to flat.
    white : DN above black, at which losses are told. EMVA weights deviations relative
    to the level."""
    used = [
        p
        for p in points
        if p.exposure_time
        and p.is_right
        and LOWEST * ceiling <= p.level <= HIGHEST * ceiling
    ]
    times = np.array([p.exposure_time for p in used], float)
    if len(set(times)) < FEWEST_LEVELS:
        return None
    levels = np.array([p.level for p in used])
    sigma = np.array([max(lamp, 1e-6) / math.sqrt(p.frames) for p in used])
    slope = np.average(levels / times, weights=1 / (sigma * levels / times) ** 2)
    bend = float(np.abs(levels / (slope * times) - 1).mean())
    line = np.polyfit(times, levels, 1, w=1 / (levels * sigma))
    deviations = 100 * (levels / np.polyval(line, times) - 1)
    error = float(np.abs(deviations).mean())
    chance = 100 * float(sigma.mean()) / math.sqrt(len(used))
    (quadratic,), cubic = _losses(times, levels, sigma, 1, white), None
    if len(set(times)) > FEWEST_LEVELS:
        both = _losses(times, levels, sigma, 2, white)
        if both[1].stands_out:
            quadratic, cubic = both
    return Linearity(
        Measured(error, chance, "%"),
        quadratic,
        cubic,
        bend,
        times,
        levels,
        deviations,
    )


def _losses(
    times: Array, levels: Array, sigma: Array, count: int, white: float
) -> list[Measured]:
    """Return by how much white falls short of a straight line, term by term, by least
    relative deviations of level over time from a polynomial."""
    rates, weights = levels / times, times / (levels * sigma)
    values, covariance = np.polyfit(times, rates, count, w=weights, cov="unscaled")
    chi2 = float(((weights * (rates - np.polyval(values, times))) ** 2).sum())
    widened = max(chi2 / max(len(times) - count - 1, 1), 1.0)
    errors = np.sqrt(np.diag(covariance) * widened)
    first = values[-1]
    return [
        Measured(float(-values[-1 - n]), float(errors[-1 - n]), "1").scaled(
            float(white**n / first ** (n + 1)), "1"
        )
        for n in range(1, count + 1)
    ]

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Flats: variance against mean in blocks of the field and where it ends, which of them
show a gain, and what they show above the darks: shading, linearity, the lamp's drift.

Source: EMVA Standard 1288, release 4.0, sections on system gain, saturation capacity
and linearity; J. R. Janesick, Photon Transfer, 2007; D. B. Goldman, IEEE Trans. PAMI
32(12), 2010 (the shading's polynomial)."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from cg2raw.calibration.darks import DarkResults, Map
from cg2raw.calibration.measured import (
    SIGNIFICANT,
    Array,
    Measured,
    clipped_moments,
    linear_fit,
)
from cg2raw.calibration.seen import Seen
from cg2raw.calibration.sites import FIELD_BLOCKS, Sites, blocks_of, centres
from cg2raw.model.full_well import CEILING, CERTAIN, MOST_CLIPPED

MANY = 0.2  # of the pixels at one DN, which noise spreads over several
RISING = 1.2  # levels of flats whose wells are full are closer than by this
# Of saturation, up to which flats show a gain. Source: EMVA 1288, release 4.0.
LINEAR = 0.7
SHADING = ("r2", "r4", "r6", "tilt_x", "tilt_y", "tilt_x_r2", "tilt_y_r2")
LOWEST, HIGHEST = 0.05, 0.95  # of saturation, between which linearity is judged
FEWEST_LEVELS = 3
FULL_WELL, AT_WHITE = "full well", "white level"


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


@dataclass
class PhotonTransfer:
    """points : of the groups of flats that repeat each other, from dark to bright.
    saturation : DN above black, of the full well or of the converter, as clipped_by
    says; None if no frame reaches it. used : numbers of groups whose noise is light's
    and that are not clipped. clipped : frames that are."""

    points: list[TransferPoints] = field(default_factory=list)
    saturation: Measured | None = None
    clipped_by: str = ""
    used: list[int] = field(default_factory=list)
    clipped: int = 0

    def linear(self, seen: Seen, black: float) -> list[int]:
        """Return numbers of flats up to LINEAR of saturation. black : DN."""
        full = self.saturation
        most = LINEAR * (full.value if full else seen.sensor.white_level - black)
        return [n for n in self.used if float(seen.levels(n).mean()) - black <= most]


@dataclass(frozen=True)
class Light:
    """Response to uniform light.

    shading : {coefficient: value}, of lens_shading. fall_off : relative, rms of that
    shading over the field. residual : relative, rms of what it leaves of the map.
    field : (blocks, blocks) relative response."""

    shading: dict[str, Measured]
    fall_off: Measured
    residual: float
    field: Array


@dataclass(frozen=True)
class Linearity:
    """Level against exposure time under one lamp.

    error : %, mean absolute deviation from the line with an offset, of the level (EMVA
    1288). quadratic, cubic : loss at white, of nonlinearity; cubic None where it does
    not stand out. bend : relative, mean absolute deviation from a line through zero,
    which these describe. levels : DN above black; deviations : %."""

    error: Measured
    quadratic: Measured
    cubic: Measured | None
    bend: float
    levels: Array
    deviations: Array


@dataclass(frozen=True, kw_only=True)
class FlatResults:
    """What flats show. response : (H, W) of each pixel, relative. lamp : relative,
    standard deviation of their light."""

    transfer: PhotonTransfer = field(default_factory=PhotonTransfer)
    light: Light | None = None
    response: Map | None = field(default=None, repr=False)
    linearity: Linearity | None = None
    lamp: Measured | None = None


def read_flats(
    seen: Seen, levels: Array, tell: Callable[[float], None]
) -> PhotonTransfer:
    """Return what is needed of flats, group by group from dark to bright.

    levels : (sites,) DN of black, of the shortest darks or the profile."""
    found, first = PhotonTransfer(), len(seen.darks)
    order = seen.groups[first:]
    top = max((s.highest for group in order for s in group.frames), default=0)
    for number, group in enumerate(order, first):
        if float((group.level - levels).min()) <= 0:
            raise ValueError(
                f"{group.frames[0].frame.name}: a flat of {group.level.mean():.1f} DN, "
                f"black is {levels.mean():.1f} DN: is it a dark? Give it among --darks"
            )
        at_top, saturated, highest = (
            np.array([getattr(s, name) for s in group.frames])
            for name in ("at_highest", "saturated", "highest")
        )
        # One DN in many pixels; what has few codes below it is quiet, not clipped.
        high = int(highest.max())
        is_white = max(at_top.mean() * (high == top), saturated.mean()) > MANY
        if is_white and not found.clipped_by:
            level = min(high, seen.white) - float(levels.mean())
            found.saturation, found.clipped_by = Measured(level, 0.5, "DN"), AT_WHITE
        if seen.repeats(number):
            take_up(found, seen, number, levels)
        elif is_white:
            found.clipped += len(group.frames)
        tell((number + 1 - first) / len(order))
    return found


def take_up(found: PhotonTransfer, seen: Seen, number: int, black: Array) -> None:
    """Add a group of flats that is brighter than those before.

    The well is full where more light brings less noise: where the variance falls below
    half of that of darker flats."""
    point = transfer_points(seen, number, black, found.points)
    found.points.append(point)
    *darker, last = (float(np.median(p.variance)) for p in found.points)
    if not found.clipped_by and darker and last < CEILING * max(darker):
        error = max(float(np.std(seen.levels(number))), 0.1 * math.sqrt(last))
        found.saturation = Measured(point.level, error, "DN")
        found.clipped_by = FULL_WELL
    if found.clipped_by or point.is_clipped:
        found.clipped += point.frames
    elif not point.is_coarse:
        found.used.append(number)


def transfer_points(
    seen: Seen, number: int, black: Array, darker: Sequence[TransferPoints]
) -> TransferPoints:
    """Return mean and variance in blocks of the field: each block is nearly uniform,
    however the light falls off. black : (sites,) DN, dark signal included.

    darker : points of darker flats, which tell where wells are full."""
    variance, error = seen.statistics.block_noise(number)
    largest = np.max([p.variance for p in darker], axis=0) if darker else 0.0
    full = variance * (1 + CERTAIN * error) < CEILING * largest
    return TransferPoints(
        seen.statistics.block_levels(number) - black[:, None],
        variance,
        error,
        float(seen.levels(number).mean() - black.mean()),
        seen.groups[number].exposure_time,
        int(seen.statistics.frames[number]),
        max(seen.clipped(number), float(np.average(full, weights=error**-2))),
        float(np.median(variance)) < seen.sites.coarse,
    )


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
            least, most = seen.sites.rounding, seen.sites.coarse
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


def above_darks(
    seen: Seen,
    flats: PhotonTransfer,
    darks: DarkResults,
    levels: Array,
    black: NDArray[np.float64],
) -> FlatResults:
    """Return what flats show once the darks are known.

    levels, black : (sites,) DN, by which flats were read, and as it is known now."""
    if not flats.points:
        return FlatResults(transfer=PhotonTransfer(clipped=flats.clipped))
    rate = darks.dark.rate.value if darks.dark else 0.0
    points = []
    for p in flats.points:
        more = black - levels + rate * (p.exposure_time or 0.0)
        mean, level = p.mean - more[:, None], p.level - float(more.mean())
        points.append(replace(p, mean=mean, level=level))
    white, full = seen.sensor.white_level - float(black.mean()), flats.saturation
    if full is not None:
        full = replace(full, value=full.value + float((levels - black).mean()))
    lamp = lamp_drift([seen.levels(n) - black.mean() for n in flats.used])
    light, response = None, None
    if flats.used:
        light, response = light_of(seen, flats.used[-1:], black, darks)
    top = full.value if full is not None else white
    return FlatResults(
        transfer=replace(flats, points=points, saturation=full),
        light=light,
        response=response,
        linearity=linearity(points, top, lamp.value if lamp else 0.0, white),
        lamp=lamp,
    )


def light_of(
    seen: Seen, numbers: Sequence[int], black: Array, darks: DarkResults
) -> tuple[Light, Map]:
    """Return the response of the mean of groups of flats of one level, and its map, in
    which each site's median is 1, and what is not known. numbers : of the groups.
    black : (sites,) DN."""
    mean = seen.mean_over(numbers)
    known = mean < seen.white
    if seen.statistics.excluded is not None:
        known &= ~seen.statistics.excluded
    mean -= seen.sites.spread(black, mean.shape)
    if darks.offset is not None:
        mean -= darks.offset
    if darks.rate is not None:
        since = seen.time(numbers[0]) - seen.time(seen.shortest[0])
        mean -= darks.rate * np.float32(since)
    for plane, used in zip(seen.sites.of(mean), seen.sites.of(known), strict=True):
        plane /= np.float32(np.median(plane[used]))
    light = field_of(mean, known, seen.sites)
    mean[~known] = 1
    return light, mean


def field_of(response: Array, known: Array, sites: Sites) -> Light:
    """Return the shading of a response.

    response : (H, W), relative, each site's median at 1, where it is known. Means of
    blocks of all pixels are fitted by least squares; dust is what they have besides.
    A block without a known pixel has the fit's value."""
    across = min(FIELD_BLOCKS, *(side // (4 * sites.side) for side in response.shape))
    maps = []
    for plane, used in zip(sites.of(response), sites.of(known), strict=True):
        blocks = zip(blocks_of(plane, across), blocks_of(used, across), strict=True)
        means = [clipped_moments(b[u])[0] if u.any() else np.nan for b, u in blocks]
        maps.append(means)
    field: Array = np.mean(maps, axis=0)
    half = math.hypot(*response.shape) / 2
    y, x = (
        (centres(length, across, sites.side) - length / 2) / half
        for length in response.shape
    )
    v, u = (one.ravel() for one in np.meshgrid(y, x, indexing="ij"))
    square = u**2 + v**2
    terms = (square, square**2, square**3, u, v, square * u, square * v)
    design = np.stack([np.ones_like(u), *terms], 1)
    filled = np.isfinite(field)
    fit = linear_fit(design[filled], field[filled])
    middle, *values = fit.values
    _, *errors = np.sqrt(np.diag(fit.covariance)) / middle
    shading = {
        name: Measured(float(value / middle), float(error), "1")
        for name, value, error in zip(SHADING, values, errors, strict=True)
    }
    rms = float(np.std(design[:, 1:] @ values / middle))
    fall_off = Measured(rms, math.sqrt(fit.variance * 8 / field.size), "1")
    field = np.where(filled, field, design @ fit.values).reshape(across, across)
    return Light(shading, fall_off, float(np.std(fit.rest)), field)


def lamp_drift(groups: Sequence[Array]) -> Measured | None:
    """Return the relative standard deviation of the lamp from flat to flat; None if no
    two flats repeat each other. groups : of each, (frames,) DN above black."""
    freedom = sum(len(levels) - 1 for levels in groups)
    if not freedom:
        return None
    squares = sum(float(((x / x.mean() - 1) ** 2).sum()) for x in groups)
    value = math.sqrt(squares / freedom)
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
    exposures = len(set(times))
    if exposures < FEWEST_LEVELS:
        return None
    levels = np.array([p.level for p in used])
    sigma = np.array([max(lamp, 1e-6) / math.sqrt(p.frames) for p in used])
    slope = np.average(levels / times, weights=1 / (sigma * levels / times) ** 2)
    bend = float(np.abs(levels / (slope * times) - 1).mean())
    line = np.polyfit(times, levels, 1, w=1 / (levels * sigma))
    deviations = 100 * (levels / np.polyval(line, times) - 1)
    chance = 100 * float(sigma.mean()) / math.sqrt(len(used))
    error = Measured(float(np.abs(deviations).mean()), chance, "%")
    (quadratic,), cubic = _losses(times, levels, sigma, 1, white), None
    if exposures > FEWEST_LEVELS:
        both = _losses(times, levels, sigma, 2, white)
        if both[1].stands_out:
            quadratic, cubic = both
    return Linearity(error, quadratic, cubic, bend, levels, deviations)


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

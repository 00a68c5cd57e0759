# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Darks: their groups are read by exposure, and what they show without light."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from cg2raw.calibration.black import (
    BiasStructure,
    Drift,
    bias_structure,
    black_levels,
    level_drift,
)
from cg2raw.calibration.dark_current import DarkCurrent, DarkPoint, dark_current
from cg2raw.calibration.dark_maps import DarkMaps, DarkSums
from cg2raw.calibration.dark_spread import DarkSpread, dark_spread
from cg2raw.calibration.frames import MOST_CUT, Group
from cg2raw.calibration.glow import Glow, glow
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.measurements import Lost, Transients, measured_in
from cg2raw.calibration.repeats import Repeats, Seen
from cg2raw.calibration.robust import CENSORED_TO, LEAST_SIGMA
from cg2raw.calibration.sites import Sites
from cg2raw.calibration.temporal_noise import TemporalNoise, temporal_noise
from cg2raw.model.figures import Figure
from cg2raw.statistics.constant import set_points


@dataclass(frozen=True)
class DarkResults:
    """What darks show; see Calibration."""

    black_level: tuple[Measured, ...] | None = None
    drift: Drift | None = None
    structure: BiasStructure | None = None
    noise: TemporalNoise | None = None
    dark: DarkCurrent | None = None
    spread: DarkSpread | None = None
    glow: Glow | None = None
    maps: DarkMaps | None = None
    transients: tuple[Transients, ...] = ()
    lost: Lost = ""
    few_codes: Measured | None = None


@dataclass
class _Read:
    """What is kept of the groups while they are read one by one."""

    sums: DarkSums | None = None
    noise: TemporalNoise | None = None
    origin_frames: int = 0


def read_darks(
    seen: Seen,
    groups: Sequence[Group],
    system_gain: float | None,
    figures: Sequence[Figure],
    tell: Callable[[float], None],
) -> DarkResults:
    """Return what groups of darks, the first of all and shortest first, show.

    system_gain : DN per electron, None if no flat has shown it.
    figures : of the fit of all frames."""
    if not groups:
        return DarkResults()
    if any(cut_share(group) > MOST_CUT for group in shortest(groups)):
        return DarkResults(cut_levels(shortest(groups)), lost="cut")
    points, transients, read = [], [], _Read()
    sites = seen.todo.sites
    numbers = set_points([group.temperature for group in groups])
    main = main_set_point(groups, numbers)
    for index, (group, number) in enumerate(zip(groups, numbers, strict=True)):
        repeats = seen.repeats(index)
        if repeats.transients is not None:
            transients.append(
                Transients(words_of(group), repeats.transients, repeats.count)
            )
        is_main = number == main
        point = taken_up(read, repeats, seen, is_main, groups, system_gain)
        points.append(replace(point, set_point=number))
        tell((index + 1) / len(groups))
    assert read.sums is not None
    maps = read.sums.maps()
    drift = level_drift(
        shortest(groups), floor_of(read.noise, figures, maps.offset.shape)
    )
    current = dark_current(points, drift.total if drift else 0.0)
    spread, shine = None, None
    if maps.rate is not None and current is not None:
        spread, shine = centred_rates(maps, current)
        anchor(maps, read.sums)
    found = DarkResults(
        *levels_of(maps, sites, read, drift),
        read.noise,
        current,
        spread,
        shine,
        maps,
        tuple(transients),
    )
    coarse = read.noise is not None and read.noise.is_coarse(sites.rounding)
    return without_noise(found, sites, groups) if coarse else found


def cut_share(group: Group) -> float:
    """Return the largest share of a dark's pixels where noise is cut."""
    return max(scanned.cut for scanned in group.frames)


def cut_levels(groups: Sequence[Group]) -> tuple[Measured, ...] | None:
    """Return the black level of each site by darks whose noise is cut; None if little
    is left of it."""
    frames = [scanned for group in groups for scanned in group.frames]
    if max(scanned.cut for scanned in frames) > CENSORED_TO:
        return None
    levels = np.array([scanned.level for scanned in frames])
    pixels = levels.size * frames[0].shape[0] * frames[0].shape[1] / levels[0].size ** 2
    chance = 2 * max(scanned.noise for scanned in frames) / math.sqrt(pixels)
    spread = levels.std(0, ddof=1) if len(frames) > 1 else np.zeros(levels.shape[1])
    errors = np.hypot(spread / math.sqrt(len(frames)), chance)
    pairs = zip(levels.mean(0), errors, strict=True)
    return tuple(Measured(float(level), float(error), "DN") for level, error in pairs)


def without_noise(
    found: DarkResults, sites: Sites, groups: Sequence[Group]
) -> DarkResults:
    """Return what darks show whose noise is rounding's: what is brighter than a step,
    and black levels that may be off by its error."""
    error = math.sqrt(sites.rounding)
    levels = tuple(
        replace(m, standard_error=math.hypot(m.standard_error, error))
        for m in found.black_level or ()
    )
    noises = [s.noise for group in shortest(groups) for s in group.frames]
    few_codes = None
    if max(noises) < LEAST_SIGMA * sites.step:
        few_codes = Measured(float(np.mean(noises)), float(np.std(noises)), "DN")
    return replace(
        found,
        black_level=levels,
        drift=None,
        structure=None,
        noise=None,
        lost="coarse",
        few_codes=few_codes,
    )


def floor_of(
    noise: TemporalNoise | None, figures: Sequence[Figure], shape: tuple[int, ...]
) -> float:
    """Return the variance of a frame's mean by noise of pixels, rows and columns."""
    if noise is None:
        return 0.0
    height, width = shape
    lines = (measured_in(figures, f"{name} noise") for name in ("row", "column"))
    rows, columns = (one.value if one else 0.0 for one in lines)
    return (
        noise.mean_read_noise.value**2 / (height * width)
        + rows**2 / height
        + columns**2 / width
    )


def shortest(groups: Sequence[Group]) -> list[Group]:
    """Return the groups of the shortest exposure."""
    least = min(group.exposure_time or 0.0 for group in groups)
    return [group for group in groups if (group.exposure_time or 0.0) == least]


def main_set_point(groups: Sequence[Group], numbers: Sequence[int]) -> int:
    """Return the set point of which there are most frames with charge."""
    least = min(group.exposure_time or 0.0 for group in groups)
    charged: dict[int, int] = {}
    for group, number in zip(groups, numbers, strict=True):
        longer = (group.exposure_time or 0.0) > least
        charged[number] = charged.get(number, 0) + longer * len(group.frames)
    return max(charged, key=lambda number: (charged[number], -number))


def taken_up(
    read: _Read,
    repeats: Repeats,
    seen: Seen,
    is_main: bool,
    groups: Sequence[Group],
    system_gain: float | None,
) -> DarkPoint:
    """Add a group to what was read; return its point of the dark current's line.

    Of other temperatures than the main one only the shortest exposure goes into the
    maps of pixels."""
    time = repeats.group.exposure_time or 0.0
    above = max(repeats.group.level.mean() - groups[0].level.mean(), 0.0)
    charge = (system_gain or 0.0) * float(above)
    if repeats.noise is not None:
        variance = float(repeats.noise.site_variance.mean())
        if read.noise is None:
            read.noise = temporal_noise(seen, repeats, charge)
    else:
        own = read.noise.mean_read_noise.value**2 if read.noise else 0.0
        variance = own + charge
    sites = seen.todo.sites
    variance = max(variance, sites.rounding)
    if read.sums is None:
        read.sums = DarkSums(repeats, variance, sites.step)
        read.origin_frames = repeats.count
        middle = 0.0
    elif is_main or time == read.sums.first_time:
        middle = read.sums.add(repeats, variance)
    else:
        middle = read.sums.middle(repeats)
    statistical = 1.25 * math.sqrt(variance / repeats.count / repeats.mean.size)
    return DarkPoint(
        time, repeats.group.temperature, 0, middle, repeats.count, statistical
    )


def centred_rates(maps: DarkMaps, current: DarkCurrent) -> tuple[DarkSpread, Glow]:
    """Return the law of pixels' rates, and the amplifier's glow.

    The map is brought to the median rate of the line, in place: the level of each
    group drifts, and the line has weighed that."""
    assert maps.rate is not None
    known = maps.known
    middle = float(np.median(maps.rate[known]))
    noise = math.sqrt(float(maps.covariance[1, 1]))
    shine = glow(np.where(known, maps.rate, np.nan))
    excess = maps.rate - middle
    if shine.stands_out:
        excess -= shine.over(maps.rate.shape)
        excess -= np.median(excess[known])
    spread = dark_spread(excess[known], noise)
    maps.rate[known] += np.float32(current.rate.value - middle)
    return spread, shine


def anchor(maps: DarkMaps, sums: DarkSums) -> None:
    """Bring the map of offsets, in place, to the level of the shortest darks: that of
    the longer ones has drifted, and the line of pixels has spread that."""
    assert maps.rate is not None
    known = maps.known
    excess = maps.offset + maps.rate * np.float32(sums.first_time) - sums.origin
    maps.offset[known] -= np.float32(np.median(excess[known]))


def levels_of(
    maps: DarkMaps, sites: Sites, read: _Read, drift: Drift | None
) -> tuple[tuple[Measured, ...], Drift | None, BiasStructure]:
    """Return (black level, drift, structure) of the map of offsets."""
    structure = bias_structure(maps.offset, maps.known, sites)
    of_level = drift.total / math.sqrt(read.origin_frames) if drift else 0.0
    black = black_levels(maps.offset, maps.known, sites, structure, of_level)
    return black, drift, structure


def words_of(group: Group) -> str:
    """Return "10 darks of 60 s at -5 C"."""
    kind, count = group.frames[0].frame.kind, len(group.frames)
    words = f"{count} {kind}{'s' if count > 1 else ''}"
    if group.exposure_time is not None:
        words += f" of {group.exposure_time:g} s"
    if group.temperature is not None:
        words += f" at {group.temperature:.1f} C"
    return words

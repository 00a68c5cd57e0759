# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""UniformFrame: one dark or flat, and which of them repeat each other.

A frame that is none of its repeats, as of a cap that was not on, is excluded by their
majority. Two that differ are refused: which one is wrong, nobody knows."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeVar

import numpy as np

from cg2raw import _core
from cg2raw.arrays import RawImage, raw_plane
from cg2raw.calibration.measured import CUT, LEFT, ROUNDS, Array
from cg2raw.calibration.sites import LEAST_REPEATS, Sites
from cg2raw.model.dark_law import MIDDLE
from cg2raw.model.fit import SAME_LIGHT
from cg2raw.normal import robust_deviation
from cg2raw.sensor import Sensor
from cg2raw.statistics import codes
from cg2raw.statistics.temperature import set_points

LEAST_SIGMA = 0.5  # steps of codes, below which no cut goes: it would lose all but one
FEWEST_CODES = 8  # DN that must occur before a missing one is no chance
MOST_CUT = 0.001  # of a dark's pixels, at 0 DN; more move its mean
MOST_SATURATED = 0.5  # of the pixels; a frame with more says nothing but its ceiling

# Of repeats of which one is off:
FEWEST = 3  # frames of which one may be off the others
FAR = 8.0  # standard deviations; what drifts lies closer
NOISIER = 2.0  # times the noise of the others
MOST_SCATTER = 0.5  # relative, of the charge of one exposure
MORE_FAR_PIXELS = 0.02  # of all; cosmic rays of a long dark hit fewer

Frame = TypeVar("Frame")


@dataclass(frozen=True)
class UniformFrame:
    """One frame without light, or of light that is the same everywhere.

    raw : () -> (H, W) uint16 DN, the active area; read when it is needed, not kept.
    exposure_time : s; None where it is not known.
    temperature : of the sensor, degrees Celsius; None where it is not known."""

    name: str
    kind: Literal["dark", "flat"]
    raw: Callable[[], RawImage]
    exposure_time: float | None = None
    iso: float | None = None
    temperature: float | None = None

    def pixels(self) -> RawImage:
        """Return (H, W) uint16 DN. Raises ValueError naming the frame."""
        try:
            return raw_plane(self.raw())
        except ValueError as error:
            raise ValueError(f"{self.name}: {error}") from None


@dataclass(frozen=True)
class Scanned:
    """A frame with what a first look at it says.

    level : (sites,) mean of each site, DN, without what lies 4 sigma off; noise : DN,
    standard deviation of these pixels, fixed patterns included; far : share of others.
    saturated : share of the pixels at the white level or above. cut : share of a dark's
    at the lowest code, where noise is cut, of the site that has most.
    highest, at_highest : the largest DN, and the share of the pixels that have it.
    step : DN, of which codes are multiples apart, 0 of one alone; codes : how many
    occur; spacing : (sites,) DN, of neighbouring codes, 0 where that is not known."""

    frame: UniformFrame
    shape: tuple[int, int]
    level: Array
    noise: float
    far: float
    saturated: float
    cut: float
    highest: int
    at_highest: float
    step: int
    codes: int
    spacing: tuple[int, ...]

    @property
    def mean_level(self) -> float:
        return float(self.level.mean())


@dataclass(frozen=True)
class Group:
    """Frames that repeat each other: same kind, exposure, temperature and light."""

    frames: tuple[Scanned, ...]

    @property
    def kind(self) -> Literal["dark", "flat"]:
        return self.frames[0].frame.kind

    @property
    def exposure_time(self) -> float | None:
        return self.frames[0].frame.exposure_time

    @property
    def temperature(self) -> float | None:
        """Their mean, degrees Celsius."""
        known = [t for s in self.frames if (t := s.frame.temperature) is not None]
        return float(np.mean(known)) if known else None

    @property
    def words(self) -> str:
        """What they are: "darks of 30 s"."""
        time = self.exposure_time
        return f"{self.kind}s" + ("" if time is None else f" of {time:g} s")

    @property
    def level(self) -> Array:
        """(sites,) DN."""
        return np.asarray(np.mean([one.level for one in self.frames], axis=0))


def scan(frame: UniformFrame, sites: Sites, sensor: Sensor) -> Scanned:
    """Return a first look at one frame. Raises ValueError for one of other bits."""
    raw = frame.pixels()
    if min(raw.shape) < (least := sites.side * LEAST_REPEATS):
        raise ValueError(
            f"{frame.name}: is {raw.shape[1]}x{raw.shape[0]}; must be at least {least} "
            "pixels wide and high"
        )
    by_site = list(_core.code_counts(raw, sites.side).astype(np.int64))
    counts = np.sum(by_site, axis=0)
    if words := codes.misfit(counts, sensor.bits, sensor.white_level):
        raise ValueError(f"{frame.name}: {words}")
    steps = [codes.step_of(part[: sensor.white_level]) for part in by_site]
    step = math.gcd(*(step for step, _ in steps))
    moments = [moments_of(part, max(step, 1)) for part in by_site]
    means, sigmas, kept, cuts = zip(*moments, strict=True)
    highest = int(np.flatnonzero(counts)[-1])
    return Scanned(
        frame,
        (raw.shape[0], raw.shape[1]),
        np.array(means),
        float(np.mean(sigmas)),
        1 - sum(kept) / raw.size,
        float(counts[sensor.white_level :].sum() / raw.size),
        max(cuts) if frame.kind == "dark" else 0.0,
        highest,
        float(counts[highest] / raw.size),
        step,
        min(count for _, count in steps),
        tuple(codes.spacing(part[: sensor.white_level]) for part in by_site),
    )


def moments_of(counts: Array, step: int) -> tuple[float, float, int, float]:
    """Return (mean, deviation, pixels within 4 sigma, share of pixels at the lowest
    code where noise is cut there) of one site, DN."""
    code = np.flatnonzero(counts)
    many, least = counts[code], LEAST_SIGMA * step
    ends = np.interp(np.array(MIDDLE) * many.sum(), np.cumsum(many), code)
    mean, sigma = float(ends.mean()), max(float(np.ptp(ends)) / 2, least)
    for _ in range(ROUNDS):
        kept = np.where(np.abs(code - mean) <= CUT * sigma, many, 0)
        mean = float(np.average(code, weights=kept))
        variance = float(np.average((code - mean) ** 2, weights=kept)) / LEFT
        sigma = max(math.sqrt(variance), least)
    return mean, sigma, int(kept.sum()), codes.cut_share(counts, step)


def in_steps(scanned: Sequence[Scanned], white: int) -> tuple[int, list[Scanned]]:
    """Return (step of the codes of all frames together, DN; the frames, the last code
    up to white being saturated). Raises ValueError for some in wider steps, or in
    steps that grow with light."""
    step = math.gcd(*(item.step for item in scanned)) or 1
    for item in scanned:
        if item.step > step and item.codes >= FEWEST_CODES:
            raise ValueError(
                f"{item.frame.name}: only one in {item.step} DN occurs, in other "
                "frames DN between: scaled from fewer bits, or companded; give frames "
                "that are coded alike, the camera's own RAW"
            )
    for site in range(len(scanned[0].spacing)):
        each = [(s.frame.name, float(s.level[site]), s.spacing[site]) for s in scanned]
        if words := codes.companded(each):
            raise ValueError(words)
    return step, [
        replace(item, saturated=max(item.saturated, item.at_highest))
        if white - step < item.highest < white
        else item
        for item in scanned
    ]


def groups_of(scanned: Sequence[Scanned]) -> list[Group]:
    """Return frames that repeat each other, darks first, then by exposure and level.

    Temperatures that lie in one chain of steps below 1 K are one set point."""
    keys: dict[tuple[str, float, int], list[Scanned]] = {}
    points = set_points([s.frame.temperature for s in scanned])
    for item, point in zip(scanned, points, strict=True):
        time = item.frame.exposure_time
        key = item.frame.kind, -1.0 if time is None else time, point
        keys.setdefault(key, []).append(item)
    found = []
    for (kind, *_), members in sorted(keys.items()):
        levels = [item.mean_level for item in members]
        parts = by_level(members, levels) if kind == "flat" else [members]
        found += [Group(tuple(part)) for part in parts]
    return found


def by_level(flats: Sequence[Frame], levels: Sequence[float]) -> list[list[Frame]]:
    """Return flats in groups of one level, each in the order in which it was given.

    levels : DN, of each."""
    order = np.argsort(levels, kind="stable")
    rising = np.asarray(levels)[order]
    ends = np.flatnonzero(rising[1:] > rising[:-1] * (1 + SAME_LIGHT)) + 1
    return [[flats[n] for n in sorted(part)] for part in np.split(order, ends)]


def screened(
    groups: Sequence[Group], black: Array
) -> tuple[list[Group], dict[str, str]]:
    """Return (groups without frames that are none of their repeats, {name: how it is
    off}). Raises ValueError for repeats that are none, if no majority says which.

    black : (sites,) DN, where no dark shows it."""
    level = float(np.mean(next((g.level for g in groups if g.kind == "dark"), black)))
    found, excluded = [], dict[str, str]()
    for group in groups:
        off = {item.frame.name: how_off(item, group, level) for item in group.frames}
        if len(group.frames) < FEWEST:
            off = dict.fromkeys(off, other_light(group, groups))
        kept = tuple(item for item in group.frames if not off[item.frame.name])
        excluded |= {name: why for name, why in off.items() if why}
        if kept:
            check_alike(Group(kept), level)
            found.append(Group(kept))
    return found, excluded


def how_off(item: Scanned, group: Group, black: float) -> str:
    """Return by what a frame is far off the majority of its repeats, "" if by nothing.

    black : DN. A level is off if it is beyond a pixel's noise, beyond what charge and
    light vary by, and far beyond what the others' levels do."""
    levels = np.array([one.mean_level for one in group.frames])
    middle = float(np.median(levels))
    noise = float(np.median([one.noise for one in group.frames]))
    far = float(np.median([one.far for one in group.frames]))
    spread = robust_deviation(levels)
    most = max(noise, SAME_LIGHT * (middle - black), FAR * spread)
    if abs(item.mean_level - middle) > most:
        return level_off(item.mean_level - middle, group, len(levels) - 1)
    others = f"that of the {len(levels) - 1} other {group.words}"
    if not noise / NOISIER <= item.noise <= noise * NOISIER:
        return f"its noise is {item.noise:.2f} DN, {others} {noise:.2f} DN"
    if item.far > far + MORE_FAR_PIXELS:
        return f"{item.far:.1%} of its pixels are far off its level, {others} {far:.1%}"
    return ""


def other_light(group: Group, groups: Sequence[Group]) -> str:
    """Return by what a single flat's level is off the flats of its exposure, "" of
    others."""
    if len(group.frames) > 1 or group.kind == "dark" or group.exposure_time is None:
        return ""
    for other in groups:
        alike = other.kind == "flat" and other.exposure_time == group.exposure_time
        if alike and other.frames[1:]:
            off = float(group.level.mean() - other.level.mean())
            return level_off(off, other, len(other.frames))
    return ""


def level_off(off: float, group: Group, count: int) -> str:
    """Return "its level is 3.0 DN above that of the 4 other darks"."""
    where = "above" if off > 0 else "below"
    return (
        f"its level is {abs(off):.1f} DN {where} that of the {count} other "
        f"{group.words}"
    )


def check_alike(group: Group, black: float) -> None:
    """Raise ValueError for frames whose levels or noise are not of one exposure."""
    by_level = sorted(group.frames, key=lambda item: item.mean_level)
    by_noise = sorted(group.frames, key=lambda item: item.noise)
    low, high, quiet, loud = by_level[0], by_level[-1], by_noise[0], by_noise[-1]
    noise = float(np.median([item.noise for item in group.frames]))
    charge = float(np.median([item.mean_level for item in group.frames])) - black
    off, what = high.mean_level - low.mean_level, ""
    if off > max(FAR * noise, MOST_SCATTER * charge):
        what = f"{high.frame.name}: is {off:.1f} DN above {low.frame.name}"
    elif loud.noise > NOISIER**2 * quiet.noise:
        what = (
            f"{loud.frame.name}: its noise is {loud.noise:.2f} DN, that of "
            f"{quiet.frame.name} {quiet.noise:.2f} DN"
        )
    if what:
        raise ValueError(
            f"{what}, and both have one kind, exposure and temperature: give frames "
            "that repeat each other, without the one that is off"
        )

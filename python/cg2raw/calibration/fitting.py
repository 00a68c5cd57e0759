# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The fit of all frames by one likelihood: its figures, and what darks have lost."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from cg2raw.calibration.frames import MOST_CUT
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.seen import Seen
from cg2raw.model.evaluation import Parameters
from cg2raw.model.figures import Figure, figures_of
from cg2raw.model.fit import SAME_LIGHT, fit
from cg2raw.model.profile_values import profile_values
from cg2raw.statistics.codes import COARSE, ROUNDING
from cg2raw.statistics.constant import PIXEL, Array, ConstantStatistics

# Share of a dark's pixels at the lowest code, beyond which nothing is left of them but
# what hot ones and dark current brighten.
MOST_LOST = 0.95
OF_LIGHT = ("gain", "PRNU", "shading")
BLACK = "black level"
LEFT = (BLACK, "read noise", *OF_LIGHT)  # where darks have lost the rest

# Why darks do not show all: noise is cut at the lowest code, codes are too coarse.
Lost = Literal["", "cut", "coarse"]


@dataclass(frozen=True)
class Fitted:
    """figures : of flats, and of darks of the main set point. others : {split: dark
    current}, of other set points, DN/s. misfit : by how much the levels of darks miss
    their line, over what their drift makes; at least 1. lost : see Lost."""

    figures: Sequence[Figure] = ()
    others: Mapping[str, Measured] = field(default_factory=dict)
    misfit: float = 1.0
    lost: Lost = ""


def lost_of(seen: Seen) -> tuple[Lost, float]:
    """Return (what the shortest darks have lost, the share of theirs that is cut)."""
    cut = max((seen.cut(n) for n in seen.shortest), default=0.0)
    if cut > MOST_CUT:
        return "cut", cut
    coarse = any(seen.is_coarse(n) for n in seen.shortest if seen.repeats(n))
    return ("coarse" if coarse else ""), 0.0


def fitted(
    seen: Seen, flats: Sequence[int], levels: Array, iso: float | None
) -> Fitted:
    """Return the figures of darks and of flats, of which the numbers are given; none
    where no two of these frames repeat each other.

    levels : (sites,) DN of black, where no dark that is used shows it."""
    lost, cut = lost_of(seen)
    step, offset = seen.sites.step, lowest_code(seen, lost == "cut")
    statistics = seen.statistics
    if step > 1 or lost == "cut":
        statistics = statistics.in_steps(step, offset)
    splits: dict[str, list[int]] = {"": []}
    for n in seen.darks:
        if shows_noise(seen, n):
            splits.setdefault(statistics.groups[n].split, []).append(n)
    darks = splits.pop("")
    used = [*darks, *(n for n in flats if shows_noise(seen, n))]
    if not used or not (statistics.frames[used] > 1).any():
        return Fitted(lost=lost)
    main = statistics.only(used)
    profile = None if darks else values_of(seen, levels, iso, lost, step, offset)
    found = fit(main, profile)
    line = found.likelihood.levels.line(found.theta)
    figures = figures_of(main, found, MOST_LOST)
    biases = [n for n in seen.shortest if n in darks]
    if 0 < len(biases) < len(used) and (statistics.frames[biases] > 1).any():
        figures = with_levels(figures, statistics.only(biases))
    if lost == "coarse":
        figures = [within_code(one) if one.name == BLACK else one for one in figures]
    figures = [in_dn(one, step, offset) for one in figures]
    if not darks:
        figures = of_flats(figures, seen, used, levels, iso, lost)
    if lost:
        kept = LEFT if cut <= MOST_LOST else OF_LIGHT
        figures = [one for one in figures if one.name in kept]
    others = {}
    for split, numbers in splits.items():
        own = statistics.only([*biases, *numbers])
        if (own.frames > 1).any():
            rates = [in_dn(one, step, offset) for one in figures_of(own, fit(own))]
            if (rate := of_all(rates, "dark current")) is not None:
                others[split] = rate
    return Fitted(figures, others, line.misfit if line else 1.0, lost)


def with_levels(
    figures: Sequence[Figure], shortest: ConstantStatistics
) -> list[Figure]:
    """Return figures with the black level by the shortest darks alone: levels of others
    may have moved between series."""
    levels = figures_of(shortest, fit(shortest), MOST_LOST)
    time = shortest.groups[0].exposure_time or 0.0
    rate = of_all(figures, "dark current") or Measured(0.0, 0.0, "DN/s")
    charge = rate.scaled(time, "DN")
    black = {
        f.site: changed(f, -charge.value, error=charge.standard_error)
        for f in levels
        if f.name == BLACK
    }
    return [black[f.site] if f.name == BLACK else f for f in figures]


def of_sites(figures: Sequence[Figure], name: str) -> tuple[Measured, ...]:
    """Return a figure of each site, without its interval; nothing if it is missing."""
    return tuple(
        Measured(one.value, float(one.standard_error), one.unit)
        for one in figures
        if one.name == name
    )


def of_all(figures: Sequence[Figure], name: str) -> Measured | None:
    """Return the mean of a figure over sites; None if it is missing. The error of a
    level is what they have in common, that of others each site's own."""
    found = of_sites(figures, name)
    if not found:
        return None
    errors = [one.standard_error for one in found]
    alone = math.hypot(*errors) / len(errors)
    error = max(errors) if name == BLACK else alone
    return Measured(sum(one.value for one in found) / len(found), error, found[0].unit)


def shows_noise(seen: Seen, number: int) -> bool:
    """Return whether the frames of a group differ in all planes, or are one."""
    planes, frames = seen.statistics.planes, seen.statistics.frames[number]
    return bool(frames < 2 or all(p.scatter[number, PIXEL] > 0 for p in planes))


def lowest_code(seen: Seen, is_cut: bool) -> int:
    """Return the lowest code, DN, of steps that all codes lie on: that at which darks
    are cut, or the first."""
    groups, step = seen.darks if is_cut else slice(None), seen.sites.step
    counts = sum(plane.codes[groups].sum(axis=0) for plane in seen.statistics.planes)
    if is_cut:
        return int(np.flatnonzero(counts)[0])
    return int(np.argmax(np.bincount(np.arange(len(counts)) % step, counts)))


def values_of(
    seen: Seen, levels: Array, iso: float | None, lost: Lost, step: int, offset: int
) -> Array:
    """Return the likelihood's parameters where no dark shows them, in steps of codes:
    noise of the profile, or of codes that hide it the middle of what it may be; 0 if
    nobody says it."""
    parameters = Parameters(len(levels))
    found = np.zeros(len(parameters))
    if lost != "coarse" and knows_noise(seen, iso):
        found = profile_values(seen.sensor, float(iso or 0), parameters)
    found[parameters.each("black_level")] = (levels - offset) / step
    found[parameters.each("read_noise")] /= step**2
    found[parameters.each("gain")] /= step
    if lost == "coarse":
        found[parameters.each("read_noise")] = (COARSE - ROUNDING) / 2
    return found


def knows_noise(seen: Seen, iso: float | None) -> bool:
    """Return whether the profile has noise at an ISO."""
    try:
        return bool(seen.sensor.noise_at(float(iso or 0)))
    except ValueError:
        return False


def of_flats(
    figures: Sequence[Figure],
    seen: Seen,
    flats: Sequence[int],
    levels: Array,
    iso: float | None,
    lost: Lost,
) -> list[Figure]:
    """Return figures of flats alone, with the black level of darks of one code. The
    gain of flats of one level has in its error what noise may be without light; it is
    missing where nobody says that."""
    found = [one for one in figures if one.name != "gain"]
    light = np.array([seen.levels(n).mean() for n in flats]) - levels.mean()
    unsure = 0.0
    if lost == "coarse":
        error = math.sqrt(seen.sites.rounding)
        black = Figure.normal(BLACK, "DN", 0.0, error)
        found += [replace(changed(black, x), site=n) for n, x in enumerate(levels)]
        unsure = (seen.sites.coarse - seen.sites.rounding) / math.sqrt(12)
    elif not knows_noise(seen, iso):
        unsure = math.inf
    if np.ptp(light) > SAME_LIGHT * light.max():
        unsure = 0.0
    if math.isfinite(unsure):
        slope = unsure / float(light.mean())
        gains = [one for one in figures if one.name == "gain"]
        found += [changed(one, error=one.value**2 * slope) for one in gains]
    return found


def within_code(figure: Figure) -> Figure:
    """Return a black level, in steps of codes, that is not less known than an even law
    within a code."""
    if figure.standard_error < math.sqrt(ROUNDING):
        return figure
    even = Figure.normal(BLACK, figure.unit, figure.value, math.sqrt(ROUNDING))
    return replace(even, site=figure.site)


def in_dn(figure: Figure, step: int, offset: int) -> Figure:
    """Return a figure whose unit of codes is a step, DN, from an offset."""
    scale = {"DN": step, "DN/s": step, "e-/DN": 1 / step}.get(figure.unit, 1)
    return changed(figure, offset if figure.name == BLACK else 0, scale)


def changed(
    figure: Figure, start: float = 0.0, scale: float = 1.0, error: float = 0.0
) -> Figure:
    """Return start + scale times a figure, with one more standard error."""
    value, own = start + scale * figure.value, scale * figure.standard_error
    total = math.hypot(own, error)
    wide = scale * (total / own if error else 1.0)
    low, high = (value + wide * (x - figure.value) for x in (figure.low, figure.high))
    return replace(figure, value=value, standard_error=total, low=low, high=high)

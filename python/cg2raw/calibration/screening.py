# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Screening: frames that are none of their repeats, as of a cap that was not on.

A frame is excluded by the majority of its repeats. Two that differ are refused: which
one is wrong, nobody knows.
"""

from collections.abc import Sequence

import numpy as np

from cg2raw.calibration.frames import SAME_LEVEL, Group, Scanned
from cg2raw.calibration.robust import MAD, Array

FEWEST = 3  # frames of which one may be off the others
FAR = 8.0  # standard deviations; what drifts lies closer
NOISIER = 2.0  # times the noise of the others
MOST_SCATTER = 0.5  # relative, of the charge of one exposure
MORE_FAR_PIXELS = 0.02  # of all; cosmic rays of a long dark hit fewer


def screened(
    groups: Sequence[Group], black: Array
) -> tuple[list[Group], dict[str, str]]:
    """Return (groups without frames that are none of their repeats, {name: how it is
    off}). Raises ValueError for repeats that are none, if no majority says which.

    black : (sites,) DN, where no dark shows it."""
    darks = [g for g in groups if g.frames[0].frame.kind == "dark"]
    level = float(np.mean(darks[0].level if darks else black))
    found, excluded = [], dict[str, str]()
    for group in groups:
        if len(group.frames) < FEWEST:
            check_alike(group, level)
            if why := other_light(group, groups):
                excluded[group.frames[0].frame.name] = why
            else:
                found.append(group)
            continue
        off = {item.frame.name: how_off(item, group, level) for item in group.frames}
        kept = [item for item in group.frames if not off[item.frame.name]]
        excluded |= {name: why for name, why in off.items() if why}
        found.append(Group(tuple(kept)))
        check_alike(found[-1], level)
    return found, excluded


def how_off(item: Scanned, group: Group, black: float) -> str:
    """Return by what a frame is far off the majority of its repeats, "" if by nothing.

    black : DN. A level is off if it is beyond a pixel's noise, beyond what charge and
    light vary by, and far beyond what the others' levels do."""
    levels = np.array([one.mean_level for one in group.frames])
    middle = float(np.median(levels))
    noise = float(np.median([one.noise for one in group.frames]))
    far = float(np.median([one.far for one in group.frames]))
    spread = MAD * float(np.median(np.abs(levels - middle)))
    most = max(noise, SAME_LEVEL * (middle - black), FAR * spread)
    others = others_of(group, len(levels) - 1)
    off = item.mean_level - middle
    if abs(off) > most:
        where = "above" if off > 0 else "below"
        return f"its level is {abs(off):.1f} DN {where} {others}"
    if not noise / NOISIER <= item.noise <= noise * NOISIER:
        return f"its noise is {item.noise:.2f} DN, {others} {noise:.2f} DN"
    if item.far > far + MORE_FAR_PIXELS:
        return f"{item.far:.1%} of its pixels are far off its level, {others} {far:.1%}"
    return ""


def other_light(group: Group, groups: Sequence[Group]) -> str:
    """Return by what a single flat's level is off the flats of its exposure, "" of
    others."""
    time, level = group.exposure_time, float(group.level.mean())
    if len(group.frames) > 1 or group.frames[0].frame.kind == "dark" or time is None:
        return ""
    for other in groups:
        first = other.frames[0].frame
        if first.kind == "flat" and first.exposure_time == time and other.frames[1:]:
            off = level - float(other.level.mean())
            where = "above" if off > 0 else "below"
            return f"its level is {abs(off):.1f} DN {where} {others_of(other)}"
    return ""


def others_of(group: Group, count: int | None = None) -> str:
    """Return "that of the 4 other darks of 30 s"."""
    many = len(group.frames) if count is None else count
    time = group.exposure_time
    words = f"that of the {many} other {group.frames[0].frame.kind}s"
    return words if time is None else f"{words} of {time:g} s"


def check_alike(group: Group, black: float) -> None:
    """Raise ValueError for frames whose levels or noise are not of one exposure."""
    order = sorted(group.frames, key=lambda item: item.mean_level)
    low, high = order[0], order[-1]
    noise = float(np.median([item.noise for item in order]))
    off = high.mean_level - low.mean_level
    charge = float(np.median([item.mean_level for item in order])) - black
    quiet, *_, loud = sorted([*order, *order], key=lambda item: item.noise)
    if off > max(FAR * noise, MOST_SCATTER * charge):
        what = f"{high.frame.name}: is {off:.1f} DN above {low.frame.name}"
    elif loud.noise > NOISIER**2 * quiet.noise:
        what = (
            f"{loud.frame.name}: its noise is {loud.noise:.2f} DN, that of "
            f"{quiet.frame.name} {quiet.noise:.2f} DN"
        )
    else:
        return
    raise ValueError(
        f"{what}, and both have one kind, exposure and temperature: give frames that "
        "repeat each other, without the one that is off"
    )

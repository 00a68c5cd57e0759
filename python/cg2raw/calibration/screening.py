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
    spread = MAD * float(np.median(np.abs(levels - middle)))
    most = max(noise, SAME_LEVEL * (middle - black), FAR * spread)
    others = others_of(group, len(levels) - 1)
    if abs(item.mean_level - middle) > most:
        return level_off(item.mean_level - middle, others)
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
            return level_off(off, others_of(other, len(other.frames)))
    return ""


def level_off(off: float, others: str) -> str:
    """Return "its level is 3.0 DN above that of others"."""
    return f"its level is {abs(off):.1f} DN {'above' if off > 0 else 'below'} {others}"


def others_of(group: Group, count: int) -> str:
    """Return "that of the 4 other darks of 30 s"."""
    time = group.exposure_time
    words = f"that of the {count} other {group.kind}s"
    return words if time is None else f"{words} of {time:g} s"


def check_alike(group: Group, black: float) -> None:
    """Raise ValueError for frames whose levels or noise are not of one exposure."""
    low, *_, high = sorted(group.frames * 2, key=lambda item: item.mean_level)
    quiet, *_, loud = sorted(group.frames * 2, key=lambda item: item.noise)
    noise = float(np.median([item.noise for item in group.frames]))
    off = high.mean_level - low.mean_level
    charge = float(np.median([item.mean_level for item in group.frames])) - black
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

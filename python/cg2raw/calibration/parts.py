# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Parts: frames that several amplifiers read, each with its own black, gain and noise.

Photon transfer is of one chain of read-out. A step in the middle of a frame, at
quarters or eighths of it, or from each column or row to the next is refused by name and
size.
"""

import math
from collections.abc import Iterator

import numpy as np
from scipy.ndimage import median_filter

from cg2raw.calibration.calibration import Calibration
from cg2raw.calibration.measured import Array
from cg2raw.normal import robust_deviation

CERTAIN = 8.0  # standard deviations of what steps are elsewhere
# What moves a number: of the temporal dark noise, of the response, of a variance.
LEAST_OFFSET, LEAST_RESPONSE, LEAST_NOISE = 0.25, 0.01, 0.1
TAPS = 8  # parts along a side, at most
NARROWEST, SHARE = 4, 32  # px on each side of a step; of the frame's side
QUARTILE = 0.3186  # of the sizes of normal deviates, over their standard deviation
SINGLE = 5  # lines: a median of as many is not moved by two that are far off
NEAR = 2  # px from a part's end, where a border was cut off
ALTERNATE = "each"  # place of a step, of lines that alternate
SIDES = ((1, "left and right", "columns"), (0, "top and bottom", "rows"))


def check_one_chain(found: Calibration) -> None:
    """Raise ValueError if the frames have parts that differ as amplifiers do."""
    for axis, sides, lines in SIDES:
        steps = dict[str, list[str]]()
        for place, words in all_steps(found, axis):
            steps.setdefault(place, []).append(words)
        if not steps:
            continue
        place = max(steps, key=lambda key: len(steps[key]))
        parts, remedy = f"{sides} parts", f"cut the frames at {lines[:-1]} {place}"
        if place == ALTERNATE:
            parts, remedy = f"odd and even {lines}", f"take every other {lines[:-1]}"
        elif len(steps) > 1:
            ends = ", ".join(sorted(steps.keys() - {ALTERNATE}, key=int))
            remedy = f"cut the frames at {lines} {ends}"
        raise ValueError(
            f"frames: {parts} differ as if read by amplifiers of their own: "
            f"{', '.join(steps[place])}; photon transfer is of one amplifier: "
            f"{remedy}, and calibrate each part alone"
        )


def all_steps(found: Calibration, axis: int) -> Iterator[tuple[str, str]]:
    """Yield (where a part ends, by what the next differs). axis : 1 for columns."""
    noise, maps = found.figure("temporal dark noise"), []
    if found.offset is not None and noise is not None:
        maps.append(("black level", found.offset, LEAST_OFFSET * noise.value, 1, "DN"))
    if found.response is not None:
        maps.append(("response", found.response, LEAST_RESPONSE, 100, "%"))
    for what, image, least, scale, unit in maps:
        # Of halves, for quadrants; medians less those of the other lines, which dust
        # does not move.
        halves = np.array_split(image if axis else image.T, 2)
        rests = [half - np.median(half, 1, keepdims=True) for half in halves]
        largest = dict[str, float]()
        for profile in (np.median(rest, 0) for rest in rests):
            for place, step in steps_of(profile, least, found.sites.side):
                largest[place] = max(largest.get(place, 0.0), abs(step))
        for place, size in largest.items():
            yield place, f"{what} by {scale * size:.3g} {unit}"
    for what, blocks, errors in noises_of(found):
        if step := step_of_halves(blocks, errors, axis):
            yield f"{found.shape[axis] // 2}", f"{what} by {100 * step:.3g} %"


def steps_of(profile: Array, least: float, side: int) -> list[tuple[str, float]]:
    """Return (place, step) of each end of a part, and of neighbours that alternate.

    profile : (N,). least : size of a step that matters. side : of the CFA's repeat."""
    width = max(NARROWEST, len(profile) // SHARE)
    found, steps = [], steps_along(median_filter(profile, SINGLE), width)
    sigma = float(np.quantile(np.abs(steps[width:-width]), 0.25)) / QUARTILE
    most = max(CERTAIN * sigma, least)
    for part in range(1, TAPS):
        middle = round(part * len(profile) / TAPS)
        near = slice(max(middle - NEAR, width), middle + NEAR + 1)
        best = near.start + int(np.argmax(np.abs(steps[near])))
        if abs(steps[best]) > most:
            found.append((str(best), float(steps[best])))
    if side == 1:
        signs = np.where(np.arange(len(profile) - 1) % 2, -1.0, 1.0)
        each = signs * np.diff(profile)
        middle_step = float(np.median(each))
        error = robust_deviation(each) / math.sqrt(len(each) / 2)
        if abs(middle_step) > max(CERTAIN * error, least):
            found.append((ALTERNATE, middle_step))
    return found


def steps_along(profile: Array, width: int) -> Array:
    """Return (N,) the step before each place, by least squares of one slope and two
    levels over @width on each side; 0 at the ends."""
    place = np.arange(2 * width) - width + 0.5
    design = np.stack([np.ones_like(place), place, place > 0], 1)
    kernel = np.linalg.pinv(design)[2]
    found = np.zeros(len(profile))
    found[width : len(profile) - width + 1] = np.correlate(profile, kernel, "valid")
    return found


def noises_of(found: Calibration) -> Iterator[tuple[str, Array, Array]]:
    """Yield (name, variances or gains, their relative errors), (blocks,); none of a
    read noise that rounding shapes."""
    tails, dark = found.tails, found.dark_variance[:, None]
    if tails is not None and tails.excess_kurtosis is not None:
        yield "variance of the read noise", tails.variance.mean(0), tails.error
    used = [point for point in found.transfer.points if point.is_right]
    if used and len(dark):
        mean = np.where(used[-1].mean > 0, used[-1].mean, np.nan)
        relative = np.sqrt((used[-1].error ** 2).mean(0) / len(dark))
        yield "gain", ((used[-1].variance - dark) / mean).mean(0), relative


def step_of_halves(blocks: Array, errors: Array, axis: int) -> float:
    """Return the step between the halves of a side, relative, without the slope of the
    blocks beside it; 0 if it is within chance, or does not matter."""
    side = math.isqrt(blocks.size)
    lines = blocks.reshape(side, side).mean(1 - axis) / blocks.mean()
    middle = len(lines) // 2
    if len(lines) < 4 or len(lines) % 2 or not np.isfinite(lines).all():
        return 0.0
    a, b, c, d = lines[middle - 2 : middle + 2]
    step = abs((c - b) - ((b - a) + (d - c)) / 2)
    # Weights 0.5, -1.5, 1.5, -0.5 of four means of a line of blocks.
    error = math.sqrt(5 * float((errors**2).mean()) / len(lines))
    return float(step) if step > max(CERTAIN * error, LEAST_NOISE) else 0.0

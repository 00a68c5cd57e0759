# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Codes: which DN occur in a frame, and what that says of how it was quantised.

counts is always (most + 1,) int64: how many pixels have each DN."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Counts = NDArray[np.int64]
Array = NDArray[np.floating[Any]]

ROUNDING = 1 / 12  # variance of rounding to a step, in its square
# Variance in squared steps below which it is rounding's: EMVA 1288, release 4.0.
COARSE = 0.24

GROWTH = 2.0  # of the distance of codes, that no scaling brings
MANY = 0.001  # share of the pixels at one code that is no chance
FEW = 100  # pixels whose values are worth a look at their step
LEAST_CODES = 3  # that a step is told from
# Pixels of a code whose neighbours are not empty by chance: of a Poisson number with
# this mean none is there with a probability of 2e-9.
DENSE = 20
LONGEST_GAP = 8  # codes between dense ones that are missing, and not between two greys
BYTE = 255  # the most of 8 bits
PILE = 5.0  # standard deviations that pixels at a code exceed those of codes below
PILE_CODES = 16  # below it, that it is compared with


def hidden(step: int) -> float:
    """Return the noise, DN, below which codes that are step DN apart hide its size."""
    return step * math.sqrt(COARSE - ROUNDING)


def step_of(counts: Counts) -> tuple[int, int]:
    """Return (step of the codes that occur, 0 of a single one; how many they are).

    Codes of the middle 98 % of the pixels count, and those that MANY have: single
    pixels, as hot ones that a camera has corrected, may have any."""
    total = np.cumsum(counts)
    used = counts > max(DENSE, MANY * total[-1])
    ends = np.searchsorted(total, [0.01 * total[-1], 0.99 * total[-1]])
    used[ends[0] : ends[1] + 1] |= counts[ends[0] : ends[1] + 1] > 0
    found = np.flatnonzero(used)
    return (int(np.gcd.reduce(np.diff(found))) if len(found) > 1 else 0), len(found)


def spacing(counts: Counts) -> int:
    """Return the usual distance from one code to the next, where chance leaves none
    out; 0 if no two codes are so frequent."""
    found = np.flatnonzero(counts)
    weight = np.minimum(counts[found[:-1]], counts[found[1:]])
    sure = weight >= DENSE
    if not sure.any():
        return 0
    distance, weight = np.diff(found)[sure], weight[sure]
    order = np.argsort(distance, kind="stable")
    total = np.cumsum(weight[order])
    return int(distance[order][np.searchsorted(total, total[-1] / 2)])


def companded(
    frames: Sequence[tuple[str, float, int]],
) -> str:
    """Return a sentence on frames of even light whose codes lie farther apart the
    brighter they are, "" if they do not.

    frames : (name, level, spacing of its codes) of each, DN. Values that a program has
    scaled are at distances that differ by one."""
    known = sorted((level, name, apart) for name, level, apart in frames if apart)
    if not known or known[-1][2] <= GROWTH * known[0][2]:
        return ""
    (low, _, near), (high, name, far) = known[0], known[-1]
    return (
        f"{name}: its codes are {far} DN apart, at {high:.0f} DN, and {near} DN at "
        f"{low:.0f} DN: companded, as by a square root, and put back by a table; "
        "give linear RAW that is not compressed so"
    )


def cut_share(counts: Counts, step: int = 1) -> float:
    """Return the share of pixels at the lowest code if noise is cut there, else 0.

    step : DN from one code to the next. A normal distribution falls ever faster, so
    that no code has more pixels than its neighbours let expect, as the lowest has that
    holds what would be below it. Above 0 frames without noise may look so, by hot
    pixels: there the next two codes must have many."""
    counts = counts[int(np.flatnonzero(counts)[0]) % step :: step]
    low, total = int(np.flatnonzero(counts)[0]), int(counts.sum())
    first, second, third = map(int, np.pad(counts, (0, 2))[low : low + 3])
    least = DENSE if low == 0 else max(DENSE, total // 100)
    is_cut = min(second, third) >= least and first * third > second**2
    all_cut = low == 0 and first > total // 2
    return first / total if is_cut or all_cut else 0.0


def gaps(counts: Counts) -> float:
    """Return the share of codes that no pixel has among those between dense ones.

    Chance leaves none: a gap counts where codes of DENSE pixels are on both sides, up
    to LONGEST_GAP codes away."""
    dense = np.flatnonzero(counts >= DENSE)
    empty = np.diff(np.cumsum(counts == 0)[dense])
    missing = int(empty[np.diff(dense) - 1 <= LONGEST_GAP].sum())
    return missing / (missing + len(dense)) if missing else 0.0


def isolated(counts: Counts) -> float:
    """Return the share of pixels, of those at dense codes, between two empty codes.

    Noise of a third of a DN already fills neighbours of dense codes; so most pixels are
    isolated only where values were coarser before they were scaled."""
    dense = counts >= DENSE
    padded = np.pad(counts, 1)
    alone = dense & (padded[:-2] == 0) & (padded[2:] == 0)
    alone[0] = False  # of pixels at 0, the codes below are cut off, not empty
    pixels = int(counts[dense].sum())
    return float(counts[alone].sum() / pixels) if pixels else 0.0


def piles_up_at_byte(counts: Counts) -> bool:
    """Return whether values end at 255, with more pixels there than chance brings.

    The codes just below have as many in a picture; PILE standard deviations more come
    by chance once in 3 million frames."""
    if len(counts) <= BYTE or counts[BYTE + 1 :].any():
        return False
    below = float(counts[BYTE - PILE_CODES : BYTE].mean())
    return bool(counts[BYTE] > 2 * below + PILE * np.sqrt(2 * below) + DENSE)


def misfit(counts: Counts, bits: int, white: int) -> str:
    """Return why a frame is none of a camera's bits and white level, DN; "" if it may
    be one."""
    most = len(np.trim_zeros(counts, "b")) - 1
    if most >= 2**bits:
        return (
            f"{most} DN does not fit into {bits} bits ({2**bits - 1}): give the sensor "
            "that recorded this frame"
        )
    if white > BYTE and piles_up_at_byte(counts):
        return (
            f"nothing is above {BYTE} DN, where pixels pile up, and white is {white} "
            "DN: an 8-bit copy; give the camera's own file"
        )
    return ""

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Codes: which DN occur in a frame, and what that says of how it was quantised.

counts is always (most + 1,) int64: how many pixels have each DN."""

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
FEW = 100  # pixels whose values are worth a look at their comb
LEAST_CODES = 3  # that a step is told from
# Pixels of a code whose neighbours are not empty by chance: of a Poisson number with
# this mean none is there with a probability of 2e-9.
DENSE = 20
LONGEST_GAP = 8  # codes between dense ones that are missing, and not between two greys
BYTE = 255  # the most of 8 bits
PILE = 5.0  # standard deviations that pixels at a code exceed those of codes below
PILE_CODES = 16  # below it, that it is compared with
# Of pairs of pixels with normal noise of half a DN, the smallest share, of those that
# differ by 3 DN or less, that differ by 2 or 3: it is 0.0445 where their mean lies
# between two codes, and up to 0.0540 in the middle of one.
APART_AT_HALF_A_DN = 0.0445
MOST_APART = 3  # DN; what differs more is hot, or an edge
CERTAIN = 5.0  # standard deviations of that share; one-sided chance 3e-7


def wave_of_rounding(variance: Array, mean: Array, spread: Array) -> Array:
    """Return what rounding adds to a variance besides ROUNDING, which depends on where
    between two codes a mean lies; all in steps of the codes, of which they are
    multiples.

    variance : of rounded values. spread : variance of the means themselves.
    Source: B. Widrow, IRE Trans. Circuit Theory 3(4), 1956; its first harmonic."""
    wave = np.zeros_like(variance)
    for _ in range(4):
        own = np.maximum(variance - ROUNDING - wave, 0)
        damped = np.exp(-2 * np.pi**2 * (own + spread))
        wave = -(4 * own + 1 / np.pi**2) * damped * np.cos(2 * np.pi * mean)
    return wave


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


def cut_share(counts: Counts) -> float:
    """Return the share of pixels at the lowest code if noise is cut there, else 0.

    counts : of neighbouring codes. A normal distribution falls ever faster, so that no
    code has more pixels than its neighbours let expect, as the lowest has that holds
    what would be below it. Above 0 frames without noise may look so, by hot pixels:
    there the next two codes must have many."""
    low, total = int(np.flatnonzero(counts)[0]), int(counts.sum())
    first, second, third = map(int, np.pad(counts, (0, 2))[low : low + 3])
    least = DENSE if low == 0 else max(DENSE, total // 100)
    is_cut = min(second, third) >= least and first * third > second**2
    all_cut = low == 0 and first > total // 2
    return first / total if is_cut or all_cut else 0.0


def comb(counts: Counts) -> tuple[int, float]:
    """Return (step of the codes that occur, share of missing ones at that step).

    Codes are looked for between the quartiles, where none is missing by chance, or, if
    those are the same few codes, in the middle 98 % of the pixels."""
    total = np.cumsum(counts)
    for share in (0.25, 0.01):
        ends = np.searchsorted(total, [total[-1] * share, total[-1] * (1 - share)])
        codes = np.flatnonzero(counts[ends[0] : ends[1] + 1])
        if len(codes) >= LEAST_CODES:
            break
    if len(codes) < LEAST_CODES or total[-1] < FEW:
        return 1, 0.0
    step = int(np.gcd.reduce(np.diff(codes)))
    return step, 1 - len(codes) / ((codes[-1] - codes[0]) // step + 1)


def gaps(counts: Counts) -> float:
    """Return the share of codes that no pixel has among those between dense ones.

    Chance leaves none: a gap counts where codes of DENSE pixels are on both sides, up
    to LONGEST_GAP codes away."""
    dense = np.flatnonzero(counts >= DENSE)
    missing = 0
    for low, high in zip(dense[:-1], dense[1:], strict=True):
        if high - low - 1 <= LONGEST_GAP:
            missing += int(np.count_nonzero(counts[low + 1 : high] == 0))
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


def is_coarse(plane: NDArray[np.uint16], side: int) -> bool:
    """Return whether noise of a dark (H, W) is certainly below half a DN.

    side : of the CFA's repeat; pixels one repeat apart are compared, whose fixed
    pattern adds to the noise, so that what is below is below."""
    away = abs(plane[:, side:].astype(np.int32) - plane[:, :-side])
    by = np.bincount(np.minimum(away, MOST_APART + 1).ravel(), minlength=MOST_APART + 2)
    count = int(by[: MOST_APART + 1].sum())
    if count < FEW:
        return False
    expected = APART_AT_HALF_A_DN
    # Neighbouring pairs share a pixel, which at most doubles the variance.
    error = np.sqrt(2 * expected * (1 - expected) / count)
    return bool(by[2 : MOST_APART + 1].sum() / count < expected - CERTAIN * error)

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The slow part of a map of pixels, and what is left without it."""

from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np
from scipy.ndimage import gaussian_filter

from cg2raw.diagnose.frames.tiling import Array, Mask

SMOOTH = 5  # pixels of one colour; a slower map is shading, and not of the pixels
KEPT = 1 - 3 / (4 * np.pi * SMOOTH**2)  # of white noise's variance, by the high pass
# The same of rates, whose maps may be far above noise: of their variance
SLOW_RATES = 12
SLOW_TURNS = 6  # a smoothing over so many pixels takes but a 2000th
SHUFFLED = 1  # seed
LEAST_SLOW_VARIANCE = 1e-200
LEAST_OF_BEST = 1e-200  # what is known of the pixel that is known best
LEAST_WEIGHT = 1e-9  # of pixels around one, of which the best known have 1 together
FAR_OUT = 3.0  # standard deviations from its surroundings, of a pixel that stands out


def high_pass(image: Array, told: Array | Mask, repeat: int) -> Array:
    """What is left of each CFA site's plane without its smooth part, where known.

    told : what is known of each pixel; one of which little is moves no other.
    repeat : side of the CFA's, px; 1 without filters. Larger ones than Bayer's have
    sites of one colour everywhere, and go by his."""
    rest = np.zeros_like(image)
    for at in _planes(repeat):
        rest[at] = image[at] - smoothed(image[at], told[at])
    return np.where(told > 0, rest, 0)


def slow_part(image: Array, known: Mask, repeat: int) -> Array:
    """The smooth part of each CFA site's plane, in which pixels that stand out leave no
    trace: smoothed are deviations from it, none by more than those of the many.

    Of pixels that differ much, any smoothing leaves some by chance: as much as where
    their places are shuffled. So much of its variance is no slow part, nor is what
    the levels of sites differ by."""
    slow = np.zeros_like(image)
    rng = np.random.default_rng(SHUFFLED)
    for at in _planes(repeat):
        where = known[at]
        if not where.any():
            continue
        shuffled = np.zeros_like(image[at])
        shuffled[where] = rng.permutation(image[at][where])
        found, chance = (_slow(plane, where) for plane in (image[at], shuffled))
        variance = found[where].var()
        real = max(1 - chance[where].var() / max(variance, LEAST_SLOW_VARIANCE), 0.0)
        slow[at] = real * (found - found[where].mean())
    return slow


def _slow(plane: Array, known: Mask) -> Array:
    found = np.full(plane.shape, np.median(plane[known]))
    for _ in range(SLOW_TURNS):
        rest = plane - found
        bound = FAR_OUT * 1.4826 * np.median(np.abs(rest[known]))
        found = found + smoothed(np.clip(rest, -bound, bound), known, SLOW_RATES)
    return np.asarray(found)


def _planes(repeat: int) -> Iterator[Any]:
    """Yield the indices of the pixels of each site of the CFA."""
    step = min(repeat, 2)
    for row, col in product(range(step), repeat=2):
        yield np.s_[:, row::step, col::step]


def smoothed(plane: Array, told: Array | Mask, size: int = SMOOTH) -> Array:
    """Return the smooth part of one site's plane (T, h, w), as far as it is told."""
    width = (0, size, size)
    share = told / max(float(told.max(initial=0)), LEAST_OF_BEST)
    weight = gaussian_filter(share, width)
    slow = gaussian_filter(np.where(told > 0, share * plane, 0), width)
    return np.asarray(slow / np.maximum(weight, LEAST_WEIGHT))

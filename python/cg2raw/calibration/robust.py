# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Robust moments: without what lies 4 sigma off, and corrected for it."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
CUT = 4.0  # sigma beyond which a pixel does not count
# Of a normal distribution, what a cut at 4 sigma leaves of its variance.
LEFT = 1 - 2 * CUT * math.exp(-CUT * CUT / 2) / math.sqrt(2 * math.pi) / math.erf(
    CUT / math.sqrt(2)
)
MAD = 1.4826  # of a normal distribution: sigma over the median absolute deviation
ROUNDS = 6
ENOUGH = 20_000  # values for a median that only begins
LEAST_SIGMA = 0.5  # steps of codes, below which no cut goes: it would lose all but one


def clipped_moments(
    values: Array, least: float = 0.0, start: tuple[float, float] | None = None
) -> tuple[float, float, int]:
    """Return (mean, standard deviation, count) of what lies within 4 sigma.

    values : any shape, finite. least : sigma of the narrowest cut, one half of a step
    where values have been rounded. start : (mean, sigma) of the first cut; else median
    and MAD, which of whole DN is an artefact, and a start alone. The deviation is
    corrected for the cut as for a normal distribution."""
    flat = values.ravel()
    if start is None:
        some = flat[:: max(1, flat.size // ENOUGH)]
        middle = float(np.median(some))
        sigma = max(MAD * float(np.median(np.abs(some - middle))), least)
    else:
        middle, sigma = start
    mean, count = middle, flat.size
    for _ in range(ROUNDS):
        kept = flat[np.abs(flat - mean) <= CUT * max(sigma, least)]
        before = count, mean
        count, mean = int(kept.size), float(kept.mean(dtype=np.float64))
        sigma = max(float(kept.std(dtype=np.float64)) / math.sqrt(LEFT), 1e-12)
        if (count, mean) == before:
            break
    return mean, sigma, count


def clipped_moments_of_counts(
    codes: Array, counts: Array, step: int
) -> tuple[float, float, int]:
    """Return clipped_moments of codes, DN in steps, that occur so often."""
    least = LEAST_SIGMA * step
    occur = counts > 0
    codes, counts = codes[occur], counts[occur]
    total = np.cumsum(counts)
    middle = float(codes[np.searchsorted(total, total[-1] / 2)])
    away = np.abs(codes - middle)
    order = np.argsort(away, kind="stable")
    half = np.searchsorted(np.cumsum(counts[order]), total[-1] / 2)
    sigma = max(MAD * float(away[order][half]), least)
    mean = middle
    for _ in range(ROUNDS):
        kept = np.where(np.abs(codes - mean) <= CUT * sigma, counts, 0)
        count = int(kept.sum())
        mean = float(kept @ codes / count)
        sigma = math.sqrt(float(kept @ (codes - mean) ** 2) / count / LEFT)
        sigma = max(sigma, least)
    return mean, sigma, count


def middle_of(values: Array, step: int = 1) -> float:
    """Return the median of DN, between codes too: that of a grouped sample.

    values : any shape, finite, wider than a step of the codes, or in steps of them."""
    half = step / 2
    flat = values.ravel()
    middle = float(np.median(flat))
    below = int(np.count_nonzero(flat < middle - half))
    inside = int(np.count_nonzero(np.abs(flat - middle) <= half))
    return middle - half + step * (flat.size / 2 - below) / max(inside, 1)


def profiles_of(image: Array) -> tuple[Array, Array]:
    """Return (2, W) columns in the upper and the lower half of an (H, W) map, and
    (2, H) rows in its left and right half: medians, once those of the other lines are
    taken off, which dust in less than half of a line does not move."""
    columns, rows = (
        np.array([_medians(half) for half in np.split(one, [len(one) // 2])], float)
        for one in (image, image.T)
    )
    return columns, rows


def _medians(image: Array) -> Array:
    """Return (w,) medians of the columns of an (h, w) map, less those of its rows."""
    found: Array = np.median(image - np.median(image, 1, keepdims=True), 0)
    return found

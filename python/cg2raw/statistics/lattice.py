# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The lattice whose pixels differ most from their neighbours: one of each square of
pitch x pitch px, as phase-detection pixels are."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw.normal import robust_deviation
from cg2raw.statistics.patterns import Lattice

Image = NDArray[np.float32]

PITCHES = range(4, 65)  # px, as the registry bounds them
FEWEST = 4  # pixels of a lattice
MOST = 2048  # px along each side, of the middle of the frame, that tell the lattice
CLIP = 4.0  # times the noise: more that one pixel differs says nothing of the others


def lattice_of(light: Image, side: int) -> Lattice | None:
    """Return the lattice that stands out most; None of frames too small for any.

    light : (H, W), in which pixels that lack light differ. side : samples along the
    CFA's repeat: a pixel's neighbours are those of its plane."""
    starts = [max(length - MOST, 0) // 2 for length in light.shape]
    middle = light[tuple(slice(start, start + MOST) for start in starts)]
    beside = _beside_neighbours(middle, side)
    known = ~np.isnan(beside)
    if not known.any():
        return None
    beside = np.nan_to_num(beside)
    clipped = np.clip(beside, -CLIP, CLIP)
    variance = float((clipped**2).sum() / known.sum()) or 1.0
    most, best, near, tried = 0.0, 0, known, 0
    for pitch in PITCHES:
        counts = folded(known, pitch)
        sums = folded(clipped, pitch)
        squares = sums**2 / np.maximum(counts, 1) * (counts >= FEWEST)
        tried += int((counts >= FEWEST).sum())
        if squares.max() > most:
            most, best, near = float(squares.max()), pitch, squares > squares.max() / 2
    if not best:
        return None
    # Pixels far off have neighbours that are, too.
    place = int(np.argmax(np.abs(folded(beside, best)) * near))
    row, column = (
        (start + at) % best
        for start, at in zip(starts, divmod(place, best), strict=True)
    )
    return Lattice(best, row, column, most / variance / 2, tried)


def _beside_neighbours(light: Image, side: int) -> Image:
    """Return (H, W) how far each pixel is from what its eight neighbours in its plane
    let expect, over the usual noise of that; without what rows and columns have in
    common, and what is smooth. nan at the edges."""
    found = np.full_like(light, np.nan)
    for place in np.ndindex(side, side):
        rest: NDArray[Any] = light[place[0] :: side, place[1] :: side]
        if min(rest.shape) < 3:
            continue
        for _ in range(2):  # second differences down, then across
            rest = (rest[1:-1] - (rest[2:] + rest[:-2]) / 2).T
        noise = robust_deviation(rest, 0.0)
        if noise > 0:
            to = found[place[0] :: side, place[1] :: side]
            to[1:-1, 1:-1] = rest / noise
    return found


def folded(values: Image | NDArray[np.bool_], pitch: int) -> NDArray[np.float64]:
    """Return (pitch, pitch) sums of values (H, W) over each lattice."""
    found: NDArray[Any] = values
    for _ in range(2):  # rows, then columns
        whole = len(found) // pitch * pitch
        cells = found[:whole].reshape(-1, pitch, found.shape[1])
        sums = cells.sum(axis=0, dtype=np.float64)
        sums[: len(found) - whole] += found[whole:]
        found = sums.T
    return found

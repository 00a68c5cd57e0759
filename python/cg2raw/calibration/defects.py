# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Defects: pixels that respond to light as none of their surroundings does.

They count in no number: their spread is not that of the others. Source: EMVA Standard
1288, release 4.0, section on defect pixels, whose bound is the application's.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cg2raw.calibration.frames import Group
from cg2raw.calibration.robust import Array, clipped_moments
from cg2raw.calibration.sites import FIELD_BLOCKS, Sites, blocks_of, centres
from cg2raw.statistics.frame_statistics import read_ahead

OFF = 1 / 3  # of the response of the surroundings; dust and shading are closer
FAR = 8.0  # standard deviations of the pixels, where these are wider than that
NO_RESPONSE = 0.05  # of the frame's median
FEWEST_PIXELS = 8  # along a block that surroundings are taken of
FRAMES = 4  # that are read of a group
SAME_CLIPPING = 0.002  # share of saturated pixels that makes no flat worse
MOST_PLACES = 4  # lines that are named


@dataclass(frozen=True)
class Defects:
    """counting : (H, W) bool, False in defects; None where all pixels count."""

    counting: NDArray[np.bool_] | None = None

    @property
    def count(self) -> int:
        return 0 if self.counting is None else int((~self.counting).sum())

    @property
    def words(self) -> str:
        """Say how many there are and where: whole lines, and the extent of the rest."""
        if self.counting is None:
            return ""
        rest, places = ~self.counting, []
        for axis, name in ((0, "column"), (1, "row")):
            lines = np.flatnonzero(rest.mean(axis) > 0.5)
            listed = ", ".join(str(line) for line in lines[:MOST_PLACES])
            if len(lines):
                more = ", ..." if len(lines) > MOST_PLACES else ""
                places.append(f"{name}{'s' * (len(lines) > 1)} {listed}{more}")
            if axis == 0:
                rest[:, lines] = False
            else:
                rest[lines] = False
        rows, columns = np.nonzero(rest)
        if len(rows):
            places.append(
                f"{len(rows)} {'others' if places else 'pixels'} in rows {rows.min()} "
                f"to {rows.max()}, columns {columns.min()} to {columns.max()}"
            )
        return (
            f"{self.count} of {rest.size} pixels respond to light by more than "
            f"{OFF:.0%} less or more than their surroundings, and are in no number: "
            f"{'; '.join(places)}"
        )


def defects_of(
    darks: Sequence[Group],
    flats: Sequence[Group],
    black: Array,
    sites: Sites,
    threads: int,
) -> Defects:
    """Return the defects that flats show above the shortest darks; none without flats.

    darks : shortest first. black : (sites,) DN, where there are none."""
    if not flats:
        return Defects()
    response = mean_of(brightest(flats), threads)
    if darks:
        response -= mean_of(darks[0], threads)
    else:
        response -= sites.spread(black, response.shape)
    counting = np.ones(response.shape, bool)
    for plane, out in zip(sites.of(response), sites.of(counting), strict=True):
        out[:] = responding(plane)
    return Defects(None if counting.all() else counting)


def brightest(flats: Sequence[Group]) -> Group:
    """Return the brightest flats among those with the fewest saturated pixels."""
    shares = [float(np.mean([f.saturated for f in g.frames])) for g in flats]
    least = min(shares) + SAME_CLIPPING
    good = [g for g, share in zip(flats, shares, strict=True) if share <= least]
    return max(good, key=lambda group: float(group.level.mean()))


def mean_of(group: Group, threads: int) -> NDArray[np.float32]:
    """Return (H, W) float32 DN, of a group's first frames."""
    frames = [scanned.frame.pixels for scanned in group.frames[:FRAMES]]
    total: NDArray[np.float32] | None = None
    for raw in read_ahead(frames, threads):
        total = raw.astype(np.float32) if total is None else total + raw
    assert total is not None
    return total / np.float32(len(frames))


def responding(plane: Array) -> NDArray[np.bool_]:
    """Return (h, w), True where one site's pixel responds as its surroundings do.

    plane : DN above dark. Surroundings are the median of nine blocks, between whose
    middles they run straight, and on to the edges: clusters as wide as a block, and
    lines, move them little."""
    level = float(np.median(plane))
    if level <= 0:
        return np.ones(plane.shape, bool)
    alive = plane > NO_RESPONSE * level
    across = min(FIELD_BLOCKS, min(plane.shape) // FEWEST_PIXELS)
    blocks = zip(blocks_of(plane, across), blocks_of(alive, across), strict=True)
    medians = [float(np.median(b[a])) if a.any() else np.nan for b, a in blocks]
    field = np.reshape(medians, (across, across))
    field = np.pad(field, 2, "reflect", reflect_type="odd")
    nine = np.lib.stride_tricks.sliding_window_view(field, (3, 3)).reshape(-1, 9)
    nine = np.where(np.isnan(nine).all(1, keepdims=True), level, nine)
    middle = np.maximum(np.nanmedian(nine, axis=1), NO_RESPONSE * level)
    rows, columns = (between(side, across) for side in plane.shape)
    surroundings = rows @ middle.reshape(across + 2, across + 2) @ columns.T
    ratio = plane / surroundings.astype(np.float32)
    sigma = clipped_moments(ratio[alive])[1]
    found: NDArray[np.bool_] = alive & (np.abs(ratio - 1) <= max(OFF, FAR * sigma))
    return found


def between(length: int, across: int) -> Array:
    """Return (length, across + 2) weights of blocks' middles, with one more before and
    behind, for the pixels of a side."""
    places, middles = np.arange(length) + 0.5, centres(length, across)
    step = length / across
    middles = np.concatenate([[middles[0] - step], middles, [middles[-1] + step]])
    units = np.eye(across + 2)
    return np.stack([np.interp(places, middles, unit) for unit in units], 1)

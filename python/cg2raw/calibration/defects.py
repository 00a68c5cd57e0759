# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Defects: pixels that respond to light as none of their surroundings does.

They count in no number: their spread is not that of the others. Source: EMVA Standard
1288, release 4.0, section on defect pixels, whose bound is the application's.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cg2raw.calibration.robust import Array, clipped_moments
from cg2raw.calibration.seen import Seen
from cg2raw.calibration.sites import FIELD_BLOCKS, blocks_of, centres

OFF = 1 / 3  # of the response of the surroundings; dust and shading are closer
FAR = 8.0  # standard deviations of the pixels, where these are wider than that
NO_RESPONSE = 0.05  # of the frame's median
FEWEST_PIXELS = 8  # along a block that surroundings are taken of
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


def defects_of(seen: Seen, black: Array) -> Defects:
    """Return the defects that the brightest flats with the fewest saturated pixels show
    above the shortest darks; none without flats. black : (sites,) DN, without darks."""
    flats = range(len(seen.darks), len(seen.groups))
    if not flats:
        return Defects()
    shares = {n: np.mean([f.saturated for f in seen.groups[n].frames]) for n in flats}
    least = min(shares.values()) + SAME_CLIPPING
    response = seen.mean_of(max(n for n in flats if shares[n] <= least))
    if seen.darks:
        response -= seen.mean_of(seen.shortest[0])
    else:
        response -= seen.sites.spread(black, response.shape)
    counting = np.ones(response.shape, bool)
    for plane, out in zip(
        seen.sites.of(response), seen.sites.of(counting), strict=True
    ):
        out[:] = responding(plane)
    return Defects(None if counting.all() else counting)


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

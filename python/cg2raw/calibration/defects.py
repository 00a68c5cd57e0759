# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Defects: pixels that respond to light as none of their surroundings does.

They count in no number: their spread is not that of the others. Source: EMVA Standard
1288, release 4.0, section on defect pixels, whose bound is the application's.
"""

import numpy as np
from numpy.typing import NDArray

from cg2raw.calibration.measured import Array, clipped_moments
from cg2raw.calibration.seen import Seen

Mask = NDArray[np.bool_]
OFF = 1 / 3  # of the response of the surroundings; dust and shading are closer
FAR = 8.0  # standard deviations of the pixels, where these are wider than that
NO_RESPONSE = 0.05  # of the frame's median
SAME_CLIPPING = 0.002  # share of saturated pixels that makes no flat worse
MOST_PLACES = 4  # lines that are named


def words_of(defects: Mask) -> str:
    """Say how many there are and where: whole lines, and the extent of the rest."""
    rest, places = defects.copy(), []
    columns, rows = (np.flatnonzero(rest.mean(axis) > 0.5) for axis in (0, 1))
    rest[:, columns] = rest[rows] = False
    for name, lines in (("column", columns), ("row", rows)):
        listed = ", ".join(map(str, lines[:MOST_PLACES]))
        if len(lines):
            more = ", ..." if len(lines) > MOST_PLACES else ""
            places.append(f"{name}{'s' * (len(lines) > 1)} {listed}{more}")
    y, x = np.nonzero(rest)
    if len(y):
        what = ("other" if places else "pixel") + "s" * (len(y) > 1)
        places.append(
            f"{len(y)} {what} in rows {y.min()} to {y.max()}, columns {x.min()} to "
            f"{x.max()}"
        )
    return (
        f"{int(defects.sum())} of {rest.size} pixels respond to light by more than "
        f"{OFF:.0%} less or more than their surroundings, and are in no number: "
        f"{'; '.join(places)}"
    )


def defects_of(seen: Seen, black: Array) -> Mask | None:
    """Return (H, W), True in the defects that the brightest flats with the fewest
    saturated pixels show above the shortest darks; None where there are none, and
    without flats. black : (sites,) DN, without darks."""
    flats = range(len(seen.darks), len(seen.groups))
    if not flats:
        return None
    shares = {n: np.mean([f.saturated for f in seen.groups[n].frames]) for n in flats}
    least = min(shares.values()) + SAME_CLIPPING
    number = max(n for n in flats if shares[n] <= least)
    mean_of = seen.statistics.mean_of
    response, dark = mean_of(number), next(iter(seen.shortest), None)
    if dark is not None:
        response -= mean_of(dark)
    else:
        response -= seen.sites.spread(black, response.shape)
    found = np.zeros(response.shape, bool)
    views = map(seen.sites.of, (response, found))
    planes = zip(seen.statistics.planes, black, *views, strict=True)
    for plane, level, above, defects in planes:
        surroundings = plane.smooth(number)
        surroundings -= level if dark is None else plane.smooth(dark)
        defects[:] = ~responding(above, surroundings)
    return found if found.any() else None


def responding(plane: Array, surroundings: Array) -> Mask:
    """Return (h, w), True where one site's pixel responds as its surroundings do; both
    are DN above dark."""
    level = float(np.median(plane))
    if level <= 0:
        return np.ones(plane.shape, bool)
    least = NO_RESPONSE * level
    alive = plane > least
    ratio = plane / np.maximum(surroundings, least)
    sigma = clipped_moments(ratio[alive])[1]
    return alive & (np.abs(ratio - 1) <= max(OFF, FAR * sigma))

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Spot map: where dust shades pixels that lie side by side, and how much.

What frames say of each pixel's gain is averaged around it. A spot is where that lies
far below what the rest of the frame varies by, whatever it is that varies there, and
around it as far as it is below at all, and fades beyond; elsewhere the map is 0.
"""

from dataclasses import replace

import numpy as np
from scipy.ndimage import (
    distance_transform_edt,
    gaussian_filter,
    label,
    maximum,
    percentile_filter,
)

from cg2raw.diagnose.effects.base import SensorMap
from cg2raw.diagnose.effects.dust import SPOT_WIDTH, pieces_of
from cg2raw.diagnose.frames.tiling import Array, Mask
from cg2raw.diagnose.inference.map_evidence import (
    LEAST_TOLD_AROUND,
    Evidence,
    mean_around,
)
from cg2raw.diagnose.likelihood.model import Term

SEARCHED = 4.0  # px: standard deviation of what spots are looked for in
EDGE_KERNEL = 4.0  # px: the same of what is left of its edges
WEIGHED = 2.0  # times as wide is what tells how strong a spot is at a pixel
SHADING_WIDTH = 32.0  # px: a slower map is shading, and no spot
DARKEST, EDGE = 5.0, 1.5  # standard deviations below the rest, of a spot and its edge
MIDDLE_PERCENT, BRIGHT_PERCENT = 50, 80  # percent: of pixels that spots leave, of all
# Shares of the frame, up to the brightest: no spot is there. How many standard
# deviations of what is free of spots these are apart, and above its middle, within
# 10 % and 0.2 of them if spots cover no more than half of the frame.
BRIGHTEST = (0.90, 0.98)
BETWEEN, BELOW = 0.84, 1.06
# Of what frames say around most pixels, that they say around one that shows nothing
# itself, as if its well is full, but lies in a spot.
LEAST_AMONG = 0.05
EDGE_SHARE = 0.4  # of a spot's radius, that it fades in beyond where it is seen
TURNS_OF_SPOTS = 3  # of spots and what is slow beside them
# Of a mean by a Gaussian g, if what is left is smoothed once more: the integral of the
# square of 2 g - g * g over that of g.
VARIANCE_OF_TWICE = 11 / 6
LEAST_FREE = 0.15  # of a row's or a frame's pixels, beside spots, to know it by


def fit_spot_map(term: Term, evidence: Evidence) -> Term:
    """Return the term with its map, and its standard deviation over the frame."""
    known = evidence.known(0)
    information = np.where(known, evidence.information[0, 0], 0)
    score = np.where(known, evidence.score[0], 0)
    none = np.zeros(score.shape)
    nothing = replace(term, values=np.zeros(1), sensor_map=SensorMap(none, none))
    if not known.any():
        return nothing
    rest, seen, spots, cores = _found(score, information)
    if not seen.any():
        return nothing
    mean, variance = none, none
    for width in (SPOT_WIDTH, EDGE_KERNEL):
        estimate, error = _twiced(rest - information * mean, information, width)
        prior = _prior_of(estimate, error, spots, width)
        share = prior / np.maximum(prior + error, LEAST_TOLD_AROUND)
        # Also where noise has left it above 0: its mean is right.
        mean, variance = mean + share * estimate, variance + share * error
    if not mean.any():
        return nothing
    chance = _pieces_with(cores, seen & (mean < 0)).astype(float)
    sigma = float(np.sqrt(np.mean(mean[known] ** 2)))
    sensor_map = SensorMap(mean, variance, chance=chance)
    return replace(term, values=np.array([sigma]), sensor_map=sensor_map)


def _prior_of(estimate: Array, error: Array, spots: Mask, width: float) -> Array:
    """Return how strong the spots are at each pixel, squared, by what is around it:
    beside their edges they are weak, and 0 where there are none."""
    around = (0, WEIGHED * width, WEIGHED * width)
    strong = gaussian_filter(np.where(spots, estimate**2 - error, 0), around)
    share = gaussian_filter(spots.astype(float), around)
    return np.where(spots, np.maximum(strong, 0) / np.maximum(share, 1e-9), 0)


def _found(score: Array, information: Array) -> tuple[Array, Mask, Mask, Mask]:
    """Return (score without what is slow beside the spots, and what rows share, as of a
    lamp that flickers; where spots are seen; the same with their edges; where they are
    far below the rest).

    The more spots are known the less is left that varies beside them, and the farther
    down their edges are seen."""
    rest = score
    seen = spots = cores = np.zeros(score.shape, bool)
    for _ in range(TURNS_OF_SPOTS):
        slow = _slow(score, information, spots)
        rest = score - information * slow
        rest = rest - information * _of_rows(rest, information, spots)
        before = seen
        seen, cores = _spots_in(rest, information, ~spots)
        if (seen == before).all():
            break
        spots = _with_edges(seen)
    return rest, seen, spots, cores


def _slow(score: Array, information: Array, spots: Mask) -> Array:
    """Return what is slow beside spots; where none is known yet, by what is bright
    around each pixel."""
    if spots.any():
        return _smoothed(score * ~spots, information * ~spots, SHADING_WIDTH)[0]
    averages, _ = _smoothed(score, information, SEARCHED)
    known = information > 0
    averages = np.where(known, averages, np.median(averages[known]))
    step = round(SEARCHED)
    few = averages[:, ::step, ::step]
    size = (1, *(2 * round(SHADING_WIDTH / step) + 1,) * 2)
    bright = percentile_filter(few, BRIGHT_PERCENT, size, mode="nearest")
    bright = bright.repeat(step, 1).repeat(step, 2)
    bright = bright[:, : score.shape[1], : score.shape[2]]
    around = (0, SHADING_WIDTH / 2, SHADING_WIDTH / 2)
    return np.asarray(gaussian_filter(bright, around, mode="nearest"))


def _of_rows(score: Array, information: Array, spots: Mask) -> Array:
    """Return what each row's pixels share beside spots: their median, or where none is
    known yet, what is bright in a row, of which spots may cover more than half."""
    told = np.where((information > 0) & ~spots, information, np.nan)
    empty = np.isfinite(told).mean(2) < LEAST_FREE
    told[empty] = 1.0
    share = MIDDLE_PERCENT if spots.any() else BRIGHT_PERCENT
    shared = np.nanpercentile(score / told, share, axis=2) * ~empty
    return np.broadcast_to(shared[:, :, None], score.shape)


def _smoothed(score: Array, information: Array, width: float) -> tuple[Array, Array]:
    """Return (estimates, their variances) of means around each pixel."""
    estimate, told = mean_around(score, information, width)
    narrower = (0, width / np.sqrt(2), width / np.sqrt(2))
    squares = gaussian_filter(information, narrower, mode="constant")
    return estimate, squares / (4 * np.pi * width**2) / told**2


def _twiced(score: Array, information: Array, width: float) -> tuple[Array, Array]:
    """Return the same with what means lose of peaks: that of a slope and of a curve is
    none. Source: J. W. Tukey, Exploratory Data Analysis, 1977."""
    once, error = _smoothed(score, information, width)
    lost, _ = _smoothed(score - information * once, information, width)
    return once + lost, VARIANCE_OF_TWICE * error


def _spots_in(score: Array, information: Array, free: Mask) -> tuple[Mask, Mask]:
    """Return where the averages lie below, in pieces that are far below somewhere, and
    where they are that.

    free : of spots, as far as is known."""
    known = information > 0
    estimate, told = mean_around(score, information, SEARCHED)
    middle, spread = _of_rest(estimate[known & free], bool(free.all()))
    among = told > LEAST_AMONG * np.median(told[known])
    below = np.where(among, (middle - estimate) / max(spread, 1e-300), 0)
    cores = below > DARKEST
    return _pieces_with(cores, below > EDGE), cores


def _of_rest(averages: Array, with_spots: bool) -> tuple[float, float]:
    """Return the middle and the standard deviation of averages beside spots; of those
    where spots may be, by the brightest."""
    if with_spots:
        low, high = np.quantile(averages, BRIGHTEST)
        spread = float(high - low) / BETWEEN
        return float(low) - BELOW * spread, spread
    middle = float(np.median(averages))
    return middle, 1.4826 * float(np.median(np.abs(averages - middle)))


def _with_edges(spots: Mask) -> Mask:
    """Return spots with as much around them as they fade in, seen or not: what a
    Gaussian has at 1.4 of the radius where it is last seen is little. As they are seen,
    if else too little of the frame were beside them."""
    grown = spots.copy()
    for tile, mask in zip(spots, grown, strict=True):
        pieces, count = label(tile)
        if not count:
            continue
        radii = maximum(distance_transform_edt(tile), pieces, np.arange(count + 1))
        away, nearest = distance_transform_edt(~tile, return_indices=True)
        mask |= away < EDGE_SHARE * radii[pieces[tuple(nearest)]]
    return spots if grown.mean() > 1 - LEAST_FREE else grown


def _pieces_with(cores: Mask, mask: Mask) -> Mask:
    """Return the connected pieces of a mask that have a core."""
    pieces, _ = pieces_of(mask)
    found: Mask = np.isin(pieces, np.unique(pieces[cores])) & (pieces > 0)
    return found

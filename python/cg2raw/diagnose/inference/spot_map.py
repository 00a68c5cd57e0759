# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Spot map: where dust shades pixels that lie side by side, and how much.

What frames say of each pixel's gain is averaged around it. A spot is where that lies
far below what the rest of the frame varies by, whatever it is that varies there, and
around it as far as it is below at all; elsewhere the map is 0.
"""

from dataclasses import replace

import numpy as np
from scipy.ndimage import gaussian_filter, label

from cg2raw.diagnose.effects.base import SensorMap
from cg2raw.diagnose.effects.dust import SPOT_WIDTH
from cg2raw.diagnose.frames.tiling import Array, Mask
from cg2raw.diagnose.inference.map_evidence import (
    LEAST_TOLD_AROUND,
    Evidence,
    mean_around,
)
from cg2raw.diagnose.likelihood.model import Term

SEARCHED = 4.0  # px: standard deviation of what spots are looked for in
WEIGHED = 3.0  # px: the same of what tells how strong a spot is at a pixel
SHADING_WIDTH = 32.0  # px: a slower map is shading, and no spot
DARKEST, EDGE = 5.0, 1.5  # standard deviations below the rest, of a spot and its edge
# Shares of the frame, up to the brightest: no spot is there. How many standard
# deviations of what is free of spots these are apart, and above its middle, within
# 10 % and 0.2 of them if spots cover no more than half of the frame.
BRIGHTEST = (0.90, 0.98)
BETWEEN, BELOW = 0.84, 1.06
TURNS_OF_SPOTS = 3  # of spots and what is slow beside them
# Of a mean by a Gaussian g, if what is left is smoothed once more: the integral of the
# square of 2 g - g * g over that of g.
VARIANCE_OF_TWICE = 11 / 6
LEAST_FREE = 0.25  # of a row's pixels, without spots, for what they share to be told


def fit_spot_map(term: Term, evidence: Evidence) -> Term:
    """Return the term with its map, and its standard deviation over the frame."""
    known = evidence.known(0)
    information = np.where(known, evidence.information[0, 0], 0)
    score = np.where(known, evidence.score[0], 0)
    none = np.zeros(score.shape)
    nothing = replace(term, values=np.zeros(1), sensor_map=SensorMap(none, none))
    if not known.any():
        return nothing
    rest, spots, cores = _found(score, information)
    estimate, error = _twiced(rest, information)
    prior = _prior_of(estimate, error, spots)
    if not prior.any():
        return nothing
    share = prior / np.maximum(prior + error, LEAST_TOLD_AROUND)
    mean = estimate * share  # also where noise has left it above 0: its mean is right
    chance = _pieces_with(cores, mean < 0).astype(float)
    sigma = float(np.sqrt(np.mean(mean[known] ** 2)))
    sensor_map = SensorMap(mean, share * error, chance=chance)
    return replace(term, values=np.array([sigma]), sensor_map=sensor_map)


def _prior_of(estimate: Array, error: Array, spots: Mask) -> Array:
    """Return how strong the spots are at each pixel, squared, by what is around it:
    beside their edges they are weak, and 0 where there are none."""
    around = (0, WEIGHED, WEIGHED)
    strong = gaussian_filter(np.where(spots, estimate**2 - error, 0), around)
    share = gaussian_filter(spots.astype(float), around)
    return np.where(spots, np.maximum(strong, 0) / np.maximum(share, 1e-9), 0)


def _found(score: Array, information: Array) -> tuple[Array, Mask, Mask]:
    """Return (score without what is slow beside the spots, and what rows share, as of a
    lamp that flickers; where spots are; where they are far below the rest).

    The more spots are known the less is left that varies beside them, and the farther
    down their edges are seen."""
    rest = score
    spots = cores = np.zeros(score.shape, bool)
    for _ in range(TURNS_OF_SPOTS):
        slow, _ = _smoothed(score * ~spots, information * ~spots, SHADING_WIDTH)
        rest = score - information * slow
        rest = rest - information * _of_rows(rest, information * ~spots)
        before = spots
        spots, cores = _spots_in(rest, information, ~spots)
        if (spots == before).all():
            break
    return rest, spots, cores


def _of_rows(score: Array, information: Array) -> Array:
    """Return what each row's pixels share: their median, which a spot does not move."""
    told = np.where(information > 0, information, np.nan)
    empty = np.isfinite(told).mean(2) < LEAST_FREE
    told[empty] = 1.0
    shared = np.nanmedian(score / told, axis=2) * ~empty
    return np.broadcast_to(shared[:, :, None], score.shape)


def _smoothed(score: Array, information: Array, width: float) -> tuple[Array, Array]:
    """Return (estimates, their variances) of means around each pixel."""
    estimate, told = mean_around(score, information, width)
    narrower = (0, width / np.sqrt(2), width / np.sqrt(2))
    squares = gaussian_filter(information, narrower, mode="constant")
    return estimate, squares / (4 * np.pi * width**2) / told**2


def _twiced(score: Array, information: Array) -> tuple[Array, Array]:
    """Return the same of means as wide as the smallest spot, with what these lose of
    peaks: that of a slope and of a curve is none. Source: J. W. Tukey, Exploratory Data
    Analysis, 1977."""
    once, error = _smoothed(score, information, SPOT_WIDTH)
    lost, _ = _smoothed(score - information * once, information, SPOT_WIDTH)
    return once + lost, VARIANCE_OF_TWICE * error


def _spots_in(score: Array, information: Array, free: Mask) -> tuple[Mask, Mask]:
    """Return where the averages lie below, in pieces that are far below somewhere, and
    where they are that.

    free : of spots, as far as is known."""
    known = information > 0
    estimate, _ = _smoothed(score, information, SEARCHED)
    middle, spread = _of_rest(estimate[known & free], bool(free.all()))
    below = np.where(known, (middle - estimate) / max(spread, 1e-300), 0)
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


def _pieces_with(cores: Mask, mask: Mask) -> Mask:
    """Return the connected pieces of a mask that have a core."""
    touching = np.zeros((3, 3, 3))
    touching[1] = 1  # not from tile to tile
    pieces, _ = label(mask, touching)
    found: Mask = np.isin(pieces, np.unique(pieces[cores])) & (pieces > 0)
    return found

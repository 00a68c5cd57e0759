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
from cg2raw.diagnose.inference.map_evidence import Evidence, mean_around
from cg2raw.diagnose.likelihood.model import Term

SEARCHED = 4.0  # px: standard deviation of what spots are looked for in
SHADING_WIDTH = 32.0  # px: a slower map is shading, and no spot
DARKEST, EDGE = 5.0, 1.5  # standard deviations below the rest, of a spot and its edge
TURNS_OF_SPOTS = 3  # of spots and what is slow beside them


def fit_spot_map(term: Term, evidence: Evidence) -> Term:
    """Return the term with its map, and its standard deviation over the frame."""
    known = evidence.known(0)
    information = np.where(known, evidence.information[0, 0], 0)
    score = np.where(known, evidence.score[0], 0)
    none = np.zeros(score.shape)
    nothing = replace(term, values=np.zeros(1), sensor_map=SensorMap(none, none))
    if not known.any():
        return nothing
    rest, spots = _found(score, information)
    estimate, error = _smoothed(rest, information, SPOT_WIDTH)
    prior = float((estimate**2 - error)[spots].mean()) if spots.any() else 0.0
    if prior <= 0:
        return nothing
    share = np.where(spots, prior / (prior + error), 0.0)
    mean = np.minimum(estimate, 0) * share  # dust does not add light
    sigma = float(np.sqrt(np.mean(mean[known] ** 2)))
    sensor_map = SensorMap(mean, share * error)
    return replace(term, values=np.array([sigma]), sensor_map=sensor_map)


def _found(score: Array, information: Array) -> tuple[Array, Mask]:
    """Return (score without what is slow beside the spots, and what rows share, as of a
    lamp that flickers; where spots are)."""
    rest, spots = score, np.zeros(score.shape, bool)
    for _ in range(TURNS_OF_SPOTS):
        slow, _ = _smoothed(score * ~spots, information * ~spots, SHADING_WIDTH)
        rest = score - information * slow
        rest = rest - information * _of_rows(rest, information * ~spots)
        before, spots = spots, _spots_in(rest, information)
        if (spots == before).all():
            break
    return rest, spots


def _of_rows(score: Array, information: Array) -> Array:
    """Return what each row's pixels share: their median, which a spot does not move."""
    told = np.where(information > 0, information, np.nan)
    empty = ~np.isfinite(told).any(2)
    told[empty] = 1.0
    shared = np.nanmedian(score / told, axis=2) * ~empty
    return np.broadcast_to(shared[:, :, None], score.shape)


def _smoothed(score: Array, information: Array, width: float) -> tuple[Array, Array]:
    """Return (estimates, their variances) of means around each pixel."""
    estimate, told = mean_around(score, information, width)
    narrower = (0, width / np.sqrt(2), width / np.sqrt(2))
    squares = gaussian_filter(information, narrower, mode="constant")
    return estimate, squares / (4 * np.pi * width**2) / told**2


def _spots_in(score: Array, information: Array) -> Mask:
    """Return where the averages lie below, in pieces that are far below somewhere."""
    known = information > 0
    estimate, _ = _smoothed(score, information, SEARCHED)
    middle = np.median(estimate[known])
    spread = 1.4826 * np.median(np.abs(estimate[known] - middle))
    below = np.where(known, (middle - estimate) / max(float(spread), 1e-300), 0)
    touching = np.zeros((3, 3, 3))
    touching[1] = 1  # not from tile to tile
    pieces, _ = label(below > EDGE, touching)
    spots: Mask = np.isin(pieces, np.unique(pieces[below > DARKEST])) & (pieces > 0)
    return spots

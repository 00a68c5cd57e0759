# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Row shifts: what estimates of the rates of a row's pixels have in common.

The offset of a row is taken from its pixels' mean, of which few fast pixels know
little. By the law of all pixels the many slow ones tell it far better.
"""

from dataclasses import replace

import numpy as np

from cg2raw.diagnose.effects.base import Values
from cg2raw.diagnose.frames.tiling import Array, Mask
from cg2raw.diagnose.inference.log_normal_law import Rates
from cg2raw.diagnose.inference.map_prior import prior_of
from cg2raw.diagnose.inference.rate_mixture import Mixture

SCORING_TURNS = 3  # of Fisher scoring, with squared slopes as information
MOVED = 0.05  # standard deviations of a pixel's estimate, between densities
FARTHEST_MOVE = 1.0  # such deviations, of a step
LEAST_BENT = 0.01  # of the curvature that a normal density has


def row_shifts(law: Mixture, rates: Rates, known: Mask, most: Array | float) -> Array:
    """Return the shifts (T, h, 1) of estimates (T, h, w), as far as they are more than
    chance, and no more than the offsets of rows make.

    most : variance of what these make of a pixel's estimate."""
    if not (np.asarray(most) > 0).any():
        return np.zeros((*known.shape[:2], 1))
    places = np.where(known, 1, np.nan)
    with np.errstate(invalid="ignore"):
        most = np.nanmedian(most * places)
        error = np.nanmedian(rates.error * places)
    filled = Rates(*(np.where(known, column, 1) for column in rates.columns))
    step = MOVED * np.sqrt(error)
    least = LEAST_BENT * np.maximum(known.sum(2, keepdims=True), 1) / error

    def slope(shift: Values) -> Array:
        """Of the log density of each pixel's estimate."""
        low, high = (
            replace(filled, estimate=filled.estimate - shift - move)
            for move in (-step, step)
        )
        change = np.logaddexp(*law.logs(high)) - np.logaddexp(*law.logs(low))
        return np.where(known, change / (2 * step), 0)

    shift, far = np.zeros((*known.shape[:2], 1)), FARTHEST_MOVE * np.sqrt(error)
    for _ in range(SCORING_TURNS):
        slopes = slope(shift)
        bend = np.maximum((slopes**2).sum(2, keepdims=True), least)
        shift = shift + np.clip(slopes.sum(2, keepdims=True) / bend, -far, far)
    used = known.any(2, keepdims=True)
    shift = shift - shift[used].mean()
    prior = min(prior_of(shift[used] ** 2, 1 / bend[used]), float(most))
    return np.asarray(used * shift * (prior * bend / (prior * bend + 1)))

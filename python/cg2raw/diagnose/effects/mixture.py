# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Mixture: residuals that are either narrow or wide."""

import numpy as np
from scipy.special import logit, ndtr, ndtri

from cg2raw.diagnose.effects.base import Whitened
from cg2raw.diagnose.frames.tiling import Array


def normal_score(
    z: Array, chance: Array | float, narrow: Array | float, wide: Array
) -> Whitened:
    """Return (residuals (T, h, w) that are standard normal if z is of the mixture, log
    of the determinant per pixel).

    chance : above 0, of being wide. narrow, wide : variances."""
    log_wide = np.log(chance) - 0.5 * z * z / wide - 0.5 * np.log(wide)
    log_narrow = np.log1p(-chance) - 0.5 * z * z / narrow - 0.5 * np.log(narrow)
    tail = chance * ndtr(-np.abs(z) / np.sqrt(wide))
    tail = tail + (1 - chance) * ndtr(-np.abs(z) / np.sqrt(narrow))
    white = -np.sign(z) * ndtri(np.maximum(tail, 1e-300))
    return white, np.logaddexp(log_wide, log_narrow) + 0.5 * white**2


def log_odds(residual: Array, chance: float, narrow: Array, wide: Array) -> Array:
    """Return the log of the odds that residuals are of the wide kind. chance : of that,
    whatever they are. narrow, wide : variances."""
    odds = logit(chance) + 0.5 * np.log(narrow / wide)
    return np.asarray(odds + 0.5 * residual**2 * (1 / narrow - 1 / wide))


def harmonic_variance(chance: Array | float, narrow: Array, wide: Array) -> Array:
    """Return the variance by which residuals tell of means: the harmonic mean of both
    kinds'. chance : of being wide."""
    return np.asarray(1 / ((1 - chance) / narrow + chance / wide))

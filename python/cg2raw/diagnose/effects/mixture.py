# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Mixture: residuals that are either narrow or wide."""

import numpy as np
from scipy.special import logit

from cg2raw import _core
from cg2raw.diagnose.effects.base import Whitened
from cg2raw.diagnose.frames.tiling import Array


def normal_score(
    z: Array, chance: Array | float, narrow: Array | float, wide: Array
) -> Whitened:
    """Return (residuals (T, h, w) that are standard normal if z is of the mixture, log
    of the determinant per pixel).

    chance : above 0, of being wide. narrow, wide : variances."""
    given = [np.broadcast_to(one, z.shape).ravel() for one in (z, chance, narrow, wide)]
    white, cost = _core.normal_scores_of_two(*given)
    return white.reshape(z.shape), cost.reshape(z.shape)


def log_odds(residual: Array, chance: float, narrow: Array, wide: Array) -> Array:
    """Return the log of the odds that residuals are of the wide kind. chance : of that,
    whatever they are. narrow, wide : variances."""
    odds = logit(chance) + 0.5 * np.log(narrow / wide)
    return np.asarray(odds + 0.5 * residual**2 * (1 / narrow - 1 / wide))


def harmonic_variance(chance: Array | float, narrow: Array, wide: Array) -> Array:
    """Return the variance by which residuals tell of means: the harmonic mean of both
    kinds'. chance : of being wide."""
    return np.asarray(1 / ((1 - chance) / narrow + chance / wide))

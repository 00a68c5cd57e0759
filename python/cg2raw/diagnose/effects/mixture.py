# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Mixture: residuals that are either narrow or wide."""

import numpy as np

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

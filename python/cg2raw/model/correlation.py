# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Correlations of noise with that of neighbours, from what line means leave of them,
and what blending leaves of noise."""

import numpy as np

from cg2raw.statistics.constant import FIELD, LAGS, Array, ConstantStatistics


def neighbours(statistics: ConstantStatistics, down: int, across: int) -> Array | None:
    """Return (G,) correlations with the sample @down rows and @across columns away; 0
    of groups without pairs. None if it was not measured.

    Residuals have lost the means of their lines and the field: white noise has -1 / n
    along a line of n, and correlation itself loses twice that, and 1 / n' of lines of
    n' that run the other way. Lines of two planes lose only half of it."""
    if (down, across) not in LAGS:
        return None
    h, w = statistics.planes[0].shape
    along, other = (w, h) if across else (h, w)
    within = down % statistics.side == 0 and across % statistics.side == 0
    measured = statistics.lags[:, LAGS.index((down, across))]
    if min(along, other) < 4:
        return 0 * measured
    if down and across:
        lost = within * (FIELD**2 - 1) / (h * w)
        return np.where(statistics.pairs > 0, measured + lost, 0.0)
    lost = 1 / along + FIELD**2 / (h * w)
    found: Array = (measured + within * lost) / (1 - (1 + within) * lost - 1 / other)
    found[statistics.pairs == 0] = 0.0
    return found


def variance_left(blend: float, diagonal: float) -> float:
    """Return the share of the variance of white noise that blending leaves."""
    return (1 - blend - diagonal) ** 2 + (blend**2 + diagonal**2) / 4


def variance_left_of_lines(blend: float, diagonal: float) -> float:
    """Return the share that blending leaves of the variance of rows, or of columns,
    whose samples are alike."""
    return (1 - blend / 2 - diagonal) ** 2 + (blend / 2 + diagonal) ** 2 / 2

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Exponential rates: of hot pixels, whose estimates have normal errors.

Source: E. Grushka, Anal. Chem. 44(11), 1972 (an exponential number with normal noise).
"""

import numpy as np
from scipy.special import log_ndtr

from cg2raw.diagnose.frames.tiling import Array

FARTHEST_BELOW = -50.0  # standard deviations, of a pixel that may be hot


def log_density(estimate: Array, deviation: Array, mean: float) -> Array:
    """Return the log density of estimates of rates of a mean."""
    steep = deviation / mean
    away = estimate / deviation
    inside = log_ndtr(away - steep)
    return np.asarray(0.5 * steep**2 - steep * away + inside - np.log(mean))


def posterior(estimate: Array, deviation: Array, mean: float) -> tuple[Array, Array]:
    """Return (mean, variance) of rates, given their estimates."""
    inside = np.maximum(estimate / deviation - deviation / mean, FARTHEST_BELOW)
    step = np.exp(-0.5 * inside**2 - log_ndtr(inside)) / np.sqrt(2 * np.pi)
    variance = deviation**2 * (1 - step * (inside + step))
    return deviation * (inside + step), np.maximum(variance, 0)

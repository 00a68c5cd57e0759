# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""An amplifier that remembers a part of the noise of the pixel that it read before."""

import numpy as np
from numpy.random import Generator

from cg2raw.synthetic.camera import Plane


def share_of(correlation: float) -> float:
    """Return the share m of the noise before for which that of neighbours, each
    x + m x_before, correlates so: m / (1 + m^2) = correlation, |correlation| < 0.5."""
    if not correlation:
        return 0.0
    return float((1 - np.sqrt(1 - 4 * correlation**2)) / (2 * correlation))


def with_memory(rng: Generator, noise: Plane, correlation: float) -> Plane:
    """Return noise (H, W) of variance 1 that remembers, of variance 1 too."""
    m = share_of(correlation)
    before = np.hstack([rng.standard_normal((len(noise), 1)), noise[:, :-1]])
    mixed: Plane = (noise + m * before) / np.sqrt(1 + m * m)
    return mixed


def told_by_before(
    residual: Plane, variance: Plane, shared: Plane
) -> tuple[Plane, Plane]:
    """Return (mean, variance that is not left) of each pixel's residual, given all
    before it in its row.

    residual : (H, W), of variance, NaN where nothing is known. shared : (H, W)
    covariance with the pixel before. Of a row's tridiagonal covariance, factor by
    factor."""
    mean, less = np.zeros((2, *residual.shape))
    for col in range(1, residual.shape[1]):
        left = variance[:, col - 1] - less[:, col - 1]
        seen = residual[:, col - 1] - mean[:, col - 1]
        slope = np.where(np.isnan(seen), 0, shared[:, col] / left)
        mean[:, col] = slope * np.nan_to_num(seen)
        less[:, col] = slope * shared[:, col]
    return mean, less

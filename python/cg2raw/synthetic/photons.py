# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The density of counted photons that are read with Gaussian noise."""

import numpy as np
from scipy.special import gammaln, logsumexp

from cg2raw.synthetic.camera import Plane

ROUNDING = 1 / 12  # DN^2, variance of rounding to 1 DN
FEW = 150.0  # photons that are summed one by one; of more the saddle point is exact
CHUNK = 4096  # pixels at a time, against memory
NEWTON_STEPS = 8


def normal(x: Plane, variance: Plane) -> Plane:
    """Return the log density of N(0, variance) at x."""
    return -0.5 * x * x / variance - 0.5 * np.log(2 * np.pi * variance)


def photon_density(
    level: Plane,
    charge: Plane,
    pedestal: Plane,
    gain: Plane,
    around: Plane,
    excess: float,
) -> Plane:
    """Return log densities, per DN, of levels that a Poisson charge was read as.

    level, pedestal : DN. charge : expected, electrons. gain : DN per electron. around :
    variance of the reading, DN^2, without rounding. excess : variance over that of
    Poisson; deviations are stretched by its root. All (H, W) but excess."""
    variance = (around + ROUNDING) / gain**2
    seen = (level - pedestal) / gain
    n = np.maximum(charge, 1e-12)
    result = _saddle_point(seen, n, variance, np.sqrt(excess))
    few = np.flatnonzero(n < FEW)
    # Pixels that were read with like noise go together: they need as wide a sum.
    few = few[np.argsort(variance.ravel()[few], kind="stable")]
    for start in range(0, len(few), CHUNK):
        part = few[start : start + CHUNK]
        y, mean, spread = (a.ravel()[part] for a in (seen, n, variance))
        result.ravel()[part] = _sum(y, mean, spread, np.sqrt(excess))
    return result - np.log(gain)


def _sum(seen: Plane, n: Plane, variance: Plane, stretch: float) -> Plane:
    """Sum over all numbers that could have been read so; electrons, (pixels,)."""
    reach = np.ceil(7 * np.sqrt(variance.max()) / stretch + 2)
    centre = np.maximum(np.round(n + (seen - n) / stretch), reach)  # from 0 on
    k = centre[:, None] + np.arange(-reach, reach + 1)
    n, seen, variance = n[:, None], seen[:, None], variance[:, None]
    log_p = k * np.log(n) - n - gammaln(k + 1)
    log_p += normal(seen - n - stretch * (k - n), variance)
    total: Plane = logsumexp(log_p, axis=1)
    return total


def _saddle_point(seen: Plane, n: Plane, variance: Plane, stretch: float) -> Plane:
    """Approximate by the cumulants' generating function, to second order.

    Source: H. E. Daniels, Annals of Mathematical Statistics 25(4), 1954."""
    t = (seen - n) / (n * stretch**2 + variance)
    for _ in range(NEWTON_STEPS):
        tilt = n * np.exp(np.clip(stretch * t, -30, 30))
        slope = n * (1 - stretch) + stretch * tilt + variance * t
        t = t - (slope - seen) / (stretch**2 * tilt + variance)
    tilt = n * np.exp(np.clip(stretch * t, -30, 30))
    function = n * (1 - stretch) * t + tilt - n + variance * t * t / 2
    second = stretch**2 * tilt + variance
    third, fourth = stretch**3 * tilt, stretch**4 * tilt
    order = fourth / (8 * second**2) - 5 * third**2 / (24 * second**3)
    return function - t * seen - 0.5 * np.log(2 * np.pi * second) + np.log1p(order)

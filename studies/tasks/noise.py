# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Noise of a sensor at an ISO: Gaussian, of a variance that is linear in the signal."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cg2raw import Sensor

Array = NDArray[np.float32]


@dataclass(frozen=True)
class Noise:
    """Variance of a site: of_signal x + constant, x in 0..1."""

    of_signal: float
    constant: float

    def added(self, planes: Array, rng: np.random.Generator) -> Array:
        """Return planes with noise, not clipped below 0."""
        variance = self.of_signal * planes.clip(0.0, None) + self.constant
        noise = rng.standard_normal(planes.shape) * np.sqrt(variance)
        return np.asarray((planes + noise).clip(None, 1.0), np.float32)


def noise_of(sensor: Sensor, iso: float) -> Noise:
    """Return the Noise of a sensor, the mean over its sites. Raises ValueError."""
    found = sensor.noise_at(iso)
    return Noise(*(float(np.mean(found[name])) for name in ("beta1", "beta2")))

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Poisson shot noise: light is counted, by Poisson's law.

A photon's skewness: E. A. Cornish, R. A. Fisher, Rev. Inst. Int. Stat. 5(4), 1938.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from cg2raw.diagnose.effects.base import (
    Effect,
    Gain,
    Parameter,
    Predicted,
    Values,
)
from cg2raw.diagnose.effects.registry import draw_noise_by
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.sensor import Sensor

FAR = 7.0  # standard deviations beyond which a series is not trusted


class PoissonShotNoise(Effect):
    name = "poisson_shot_noise"
    title = "Poisson shot noise"
    where = "lopsided noise at low levels"
    of_mean = False
    of_images = True
    fitted = (Parameter("fraction", 0, 1.5),)
    signature = frozenset({"noise"})

    def third_cumulant(self, p: Prediction) -> Array:
        """Return that of light, by its photons."""
        return p.photon_variance**2 / np.maximum(p.exposed, 1e-12)

    def whitened(
        self, z: Array, p: Prediction, is_counted: bool, more: float
    ) -> tuple[Array, Array]:
        """Return (residuals (T, h, w) that are standard normal by their third and
        fourth cumulants, log of their slope), by the Cornish-Fisher series.

        is_counted : whether light has those of Poisson's law, or none. more : third
        cumulant of what does not depend on light."""
        third = self.third_cumulant(p) * is_counted
        fourth = third * p.photon_variance / np.maximum(p.exposed, 1e-12)
        skew = np.clip((third + more) / p.variance**1.5, -0.35, 0.35)
        excess = np.minimum(fourth / p.variance**2, 0.12)
        c = np.clip(z, -FAR, FAR)
        square = c * c
        white = c - skew / 6 * (square - 1) - excess / 24 * (square - 3) * c
        white += skew**2 / 36 * (4 * square - 7) * c
        slope = 1 - skew / 3 * c - excess / 24 * (3 * square - 3)
        slope += skew**2 / 36 * (12 * square - 7)
        near = np.abs(z) < FAR
        cost = np.where(near, np.log(np.maximum(slope, 0.05)), 0.0)
        return np.where(near, white, z), cost

    def expected_gain(self, selected: Predicted) -> Gain:
        """Skewness and kurtosis of a normal distribution cost these shares of a nat."""
        skew, excess = 0.0, 0.0
        for frame, p in selected:
            photons = np.maximum(p.exposed, 1e-12)
            third = p.photon_variance**2 / photons / p.variance**1.5
            fourth = p.photon_variance**3 / photons**2 / p.variance**2
            skew += float((third[frame.keep] ** 2).sum()) / 12
            excess += float((fourth[frame.keep] ** 2).sum()) / 48
        return lambda fraction: fraction**2 * (skew + excess)

    def profile_values(
        self, sensor: Sensor, row: Mapping[str, Any], read_noise: float
    ) -> tuple[float, ...] | None:
        return (1.0,) if self.name in sensor.noise_effects else None

    def change_noise_table(self, profile: dict[str, Any], values: Values) -> bool:
        draw_noise_by(profile, self.name, "shot_noise")
        return True


EFFECT = PoissonShotNoise()

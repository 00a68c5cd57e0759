# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Heavy-tailed noise: a share of the read noise is wider than the rest."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from cg2raw.diagnose.effects.base import (
    Effect,
    Gain,
    Parameter,
    Predicted,
    Values,
    Whitened,
    WhiteningStage,
)
from cg2raw.diagnose.effects.families import TEMPORAL
from cg2raw.diagnose.effects.mixture import normal_score
from cg2raw.diagnose.effects.registry import draw_noise_by
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.sensor import Sensor

NOISY = 9.0  # variance of the wide share, over the rest's, for what would be found
READ_SHARES = 20  # classes of pixels by how much of their noise is read noise
STANDARD = np.linspace(-15, 15, 1501)
NORMAL_LAMBDA = 0.14  # Tukey's lambda that is nearest to a normal


class HeavyTailedNoise(Effect):
    name = "heavy_tailed_noise"
    title = "heavy-tailed read noise"
    where = "outliers in darks that do not repeat"
    estimator = "transform"
    search = (
        Parameter("fraction", 1e-4, 0.5),
        Parameter("variance_ratio", 1.1, 80.0),
    )
    step = 0.01
    starts = ((0.01, 9.0), (0.03, 9.0), (0.01, 25.0))
    switches = ("fraction",)
    families = frozenset({TEMPORAL})
    signature = frozenset({"noise"})
    absorbs = True
    moves_mean = False
    whitening = WhiteningStage.READOUT

    def whiten(
        self, z: Array, p: Prediction, values: Values, frame: Frame, read: Array
    ) -> Whitened:
        """The normal score of a mixture of two normals, of the variance as it was; near
        the full well its density has it (full_well)."""
        fraction, ratio = values
        of_read = np.minimum(read / p.variance, 1)
        core = of_read / (1 + fraction * (ratio - 1))
        wide, narrow = 1 - of_read + ratio * core, 1 - of_read + core
        white, cost = normal_score(z, fraction, narrow, wide)
        if not np.any(p.near_well):
            return white, cost
        return np.where(p.near_well, z, white), np.where(p.near_well, 0, cost)

    def tails(self, values: Values) -> tuple[float, float]:
        return float(values[0]), float(values[1])

    def expected_gain(
        self, selected: Predicted, fitted: Predicted, information: float
    ) -> Gain:
        shares = np.concatenate(
            [(np.minimum(f.beta2 / p.variance, 1))[f.keep] for f, p in selected]
        )
        count, edges = np.histogram(shares, READ_SHARES, (0, 1))
        middles = (edges[1:] + edges[:-1]) / 2

        def gain(fraction: float) -> float:
            core = middles[:, None] / (1 + fraction * (NOISY - 1))
            rest = 1 - middles[:, None]
            density = (1 - fraction) * _normal(rest + core)
            density = density + fraction * _normal(rest + NOISY * core)
            ratio = np.log(density / _normal(np.ones((1, 1))))
            nats = (density * ratio).sum(1) * (STANDARD[1] - STANDARD[0])
            return float(count @ nats)

        return gain

    def profile_values(
        self, sensor: Sensor, row: Mapping[str, Any], read_noise: float
    ) -> tuple[float, ...] | None:
        if self.name not in sensor.noise_effects:
            return None
        if not row.get("outlier_fraction", 0.0) > 0:
            return None
        return row["outlier_fraction"], row["outlier_variance_ratio"]

    def change_noise_table(self, profile: dict[str, Any], values: Values) -> bool:
        draw_noise_by(profile, self.name, "read_noise")
        for row in profile.get("noise", []):
            row["tukey_lambda"] = NORMAL_LAMBDA
            row["row_sigma"] = 0.0
            row["outlier_fraction"] = float(values[0])
            row["outlier_variance_ratio"] = float(values[1])
        return True


def _normal(variance: Values) -> Values:
    density: Values = np.exp(-0.5 * STANDARD**2 / variance)
    return density / np.sqrt(2 * np.pi * variance)


EFFECT = HeavyTailedNoise()

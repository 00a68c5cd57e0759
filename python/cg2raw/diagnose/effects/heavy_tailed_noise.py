# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Heavy-tailed noise: a share of the read noise is wider than the rest."""

from collections.abc import Mapping
from typing import Any

from cg2raw.diagnose.effects.base import (
    Effect,
    Parameter,
    Values,
)
from cg2raw.diagnose.effects.registry import draw_noise_by
from cg2raw.normal import TUKEY_LAMBDA
from cg2raw.sensor import Sensor


class HeavyTailedNoise(Effect):
    name = "heavy_tailed_noise"
    title = "heavy-tailed read noise"
    where = "outliers in darks that do not repeat"
    of_mean = False
    fitted = (
        Parameter("fraction", 1e-4, 0.5),
        Parameter("variance_ratio", 1.1, 80.0),
    )
    signature = frozenset({"noise"})

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
            row["tukey_lambda"] = TUKEY_LAMBDA
            row["row_sigma"] = 0.0
            row["outlier_fraction"] = float(values[0])
            row["outlier_variance_ratio"] = float(values[1])
        return True


EFFECT = HeavyTailedNoise()

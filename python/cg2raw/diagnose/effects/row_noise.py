# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Row noise: an offset for each row, new in every frame."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from cg2raw.diagnose.effects.shared_offset import SharedOffset
from cg2raw.sensor import Sensor


class RowNoise(SharedOffset):
    name = "row_noise"
    title = "row noise"
    where = "rows differ, anew in every frame"
    in_photon_transfer = True
    told_apart = {
        "column_fixed_pattern": "Several darks: row noise is new in each, a column "
        "fixed pattern repeats, read noise has no direction.",
    }

    def variance_in_table(self, sensor: Sensor, row: Mapping[str, Any]) -> float:
        return _sigma_in_table(sensor, row) ** 2

    def profile_values(
        self, sensor: Sensor, row: Mapping[str, Any], read_noise: float
    ) -> tuple[float, ...] | None:
        listed = self.sigma_in_effects(sensor)
        sigma = float(np.hypot(_sigma_in_table(sensor, row), listed))
        return (sigma / read_noise,) if sigma else None


def _sigma_in_table(sensor: Sensor, row: Mapping[str, Any]) -> float:
    """Return what physical noise draws of rows."""
    drawn = "heavy_tailed_noise" in sensor.noise_effects
    return row.get("row_sigma", 0.0) if drawn else 0.0


EFFECT = RowNoise()

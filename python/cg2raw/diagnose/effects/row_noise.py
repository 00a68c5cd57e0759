# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Row noise: an offset for each row, new in every frame."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cg2raw.diagnose.effects.base import (
    TEMPORAL,
    Effect,
    Estimates,
    Gain,
    Parameter,
    Predicted,
    Values,
    Whitened,
    WhiteningStage,
    value_of,
)
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.sensor import Sensor


class RowNoise(Effect):
    """Its value is in read noises; the registry's is of white."""

    name = "row_noise"
    title = "row noise"
    where = "rows differ, anew in every frame"
    measured_by_uniform_frames = True
    estimator = "transform"
    search = (Parameter("sigma", 0, 4),)
    step = 0.01
    starts = ((0.03,), (0.1,), (0.3,), (0.8,))
    families = frozenset({TEMPORAL})
    signature = frozenset({"noise"})
    absorbs = True
    moves_mean = False
    in_photon_transfer = True
    shares_rows = True
    whitening = WhiteningStage.ROWS
    linear = True
    told_apart = {
        "column_fixed_pattern": "Several darks: row noise is new in each, a column "
        "fixed pattern repeats, read noise has no direction.",
    }

    def whiten(
        self, z: Array, p: Prediction, values: Values, frame: Frame, read: Array
    ) -> Whitened:
        """Shrink each row's common offset: a covariance of rank one a row."""
        return _to_power(z, p, values, frame, -0.5)

    def colour(self, z: Array, p: Prediction, values: Values, frame: Frame) -> Array:
        return _to_power(z, p, values, frame, 0.5)[0]

    def unit_scale(self, frames: Sequence[Frame]) -> float:
        if not frames:
            return 1.0
        return float(np.sqrt(np.mean([frame.beta2.mean() for frame in frames])))

    def expected_gain(
        self, selected: Predicted, fitted: Predicted, information: float
    ) -> Gain:
        told = []
        for frame, p in selected:
            of_row = frame.tiles.over_rows(frame.keep / p.variance)
            beside = frame.tiles.over_rows(np.ones_like(p.variance))
            told.append((of_row, 1 / (beside / p.variance.shape[2])))

        def gain(sigma: float) -> float:
            return sum(
                float((w * (sigma**2 * t - np.log1p(sigma**2 * t))).sum()) / 2
                for t, w in told
            )

        return gain

    def variance_in_table(self, sensor: Sensor, row: Mapping[str, Any]) -> float:
        return _sigma_in_table(sensor, row) ** 2

    def profile_values(
        self, sensor: Sensor, row: Mapping[str, Any], read_noise: float
    ) -> tuple[float, ...] | None:
        sigma = _sigma_in_table(sensor, row)
        for effect in sensor.effects:
            if effect["name"] == self.name:
                sigma = float(np.hypot(sigma, effect["parameters"]["sigma"]))
        return (sigma / read_noise,) if sigma else None

    def size(self, values: Estimates) -> str:
        return f"standard deviation {value_of(values, 'sigma'):.4g} of white"


def _sigma_in_table(sensor: Sensor, row: Mapping[str, Any]) -> float:
    """Return what physical noise draws of rows."""
    drawn = "heavy_tailed_noise" in sensor.noise_effects
    return row.get("row_sigma", 0.0) if drawn else 0.0


def _to_power(
    z: Array, p: Prediction, values: Values, frame: Frame, power: float
) -> Whitened:
    """Multiply z by a power of the covariance that offsets of rows give it: -0.5
    whitens, 0.5 colours."""
    share = (values[0] ** 2 * frame.beta2.mean()) / p.variance * frame.keep
    total = frame.tiles.over_rows(share) + 1e-300
    eigenvalue = 1 + total
    direction = np.sqrt(share / total)
    along = direction * frame.tiles.over_rows(direction * z)
    white = z - (1 - eigenvalue**power) * along
    count = np.maximum(frame.tiles.over_rows(frame.keep.astype(float)), 1)
    return white, power * np.log(eigenvalue) / count * frame.keep


EFFECT = RowNoise()

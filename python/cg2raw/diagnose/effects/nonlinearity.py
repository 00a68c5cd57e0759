# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Nonlinearity: the signal is not proportional to the light."""

import numpy as np
from numpy.typing import NDArray

from cg2raw.diagnose.diagnosis import Curve
from cg2raw.diagnose.effects.base import Effect, Estimates, MeasuredRatio, Values
from cg2raw.diagnose.effects.interval_curve import CURVE_POINTS, curve_with_interval
from cg2raw.diagnose.effects.sizes import percent, total
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction

CURVE_LEVELS = 20


class Nonlinearity(Effect):
    name = "nonlinearity"
    title = "nonlinear response"
    where = "depends on the level alone"
    step = 2e-3
    signature = frozenset({"gain"})

    def size(self, values: Estimates) -> str:
        loss = total(values, "quadratic", "cubic")
        return f"white reads {percent(abs(loss))} too {'low' if loss > 0 else 'high'}"

    def curve(
        self, values: Values, estimates: Estimates, measured: MeasuredRatio
    ) -> Curve:
        x = np.linspace(0.02, 1, CURVE_POINTS)
        design = np.stack([-x, -(x**2)], 1)
        level, ratio = measured(_level, CURVE_LEVELS)
        return Curve(
            "Response of the sensor",
            "light, 1 is white",
            "signal per light",
            x,
            *curve_with_interval(values, estimates, design),
            (level + 0.5) / CURVE_LEVELS,
            ratio,
            self.name,
        )


def _level(frame: Frame, p: Prediction) -> NDArray[np.int64]:
    levels: NDArray[np.int64] = (p.mean * CURVE_LEVELS).astype(int)
    return np.clip(levels, 0, CURVE_LEVELS - 1)


EFFECT = Nonlinearity()

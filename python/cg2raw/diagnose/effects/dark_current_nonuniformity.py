# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Dark-current non-uniformity: charge gathers faster in some pixels than in others."""

from collections.abc import Mapping

import numpy as np
from scipy.stats import norm

from cg2raw.diagnose.effects.base import NORMAL_95, Estimates, Parameter, SensorMap
from cg2raw.diagnose.effects.families import PEDESTAL, TEMPORAL, TIME
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.effects.sizes import of_white, value_of
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.sensor import Sensor


class DarkCurrentNonuniformity(FixedPattern):
    """Its value is half of the range of the middle 68.3 % of the pixels' rates; its map
    is of rates, beside their median. Few pixels far above the others are hot_pixels."""

    name = "dark_current_nonuniformity"
    title = "dark-current non-uniformity"
    where = "the same pixels in all frames, with exposure time"
    search = (Parameter("sigma", 0.0, 10.0, "1/s"),)
    families = frozenset({TEMPORAL, PEDESTAL})
    needs = TIME
    is_log_normal = True
    is_charge = True
    lacks_slow_part = True  # that is dark current's own, or an amplifier's glow
    # A law that is not quite log-normal; and of what frames do not tell of each pixel,
    # a mean and a slope that are left by chance.
    taken_up_by = {
        "dark_current": 0.01,
        "amplifier_glow": 0.01,
        "black_level": 0.01,
        "black_level_drift": 0.01,
        "hot_pixels": 0.02,
        "poisson_shot_noise": 0.005,
    }
    told_apart = {
        "dsnu": "Darks of two exposure times: DSNU is the same in both, what charge "
        "leaves grows with time.",
        "hot_pixels": "Several long darks: hot pixels are few, far above the others; "
        "where dark current differs, all pixels do.",
        "dark_current": "Several long darks: dark current lifts all pixels alike.",
    }

    def sensitivity(self, frame: Frame, photons: Array) -> float:
        return frame.seconds

    def share_beyond(
        self, parameters: Mapping[str, float], signal: float, seconds: float
    ) -> float:
        charge, spread = parameters["rate"] * seconds, parameters["log_sigma"]
        if charge <= 0 or spread <= 0:
            return 0.0
        return float(norm.sf(np.log1p(signal / charge) / spread))

    def strength_of(self, stated: Mapping[str, float]) -> float:
        return float(stated["rate"] * np.sinh(stated["log_sigma"]))

    def standard_error(self, value: float, sensor_map: SensorMap) -> float:
        low, high = self.interval(value, sensor_map)
        return (high - low) / (2 * NORMAL_95)

    def interval(self, value: float, sensor_map: SensorMap) -> tuple[float, float]:
        """That of the law's fit."""
        if "sigma" not in sensor_map.law:
            return 0.0, 0.0
        return sensor_map.law["sigma"].ci95

    def registry_estimates(
        self, estimates: Estimates, sensor_map: SensorMap | None
    ) -> Estimates:
        """The numbers of the log-normal law by which rates differ."""
        assert sensor_map is not None
        return {name: sensor_map.law[name] for name in ("rate", "log_sigma")}

    def size_in(self, values: Estimates, sensor: Sensor | None) -> str:
        sigma = of_white(value_of(values, "sigma"), sensor)
        return f"the rates of pixels differ by {sigma} per second"


EFFECT = DarkCurrentNonuniformity()

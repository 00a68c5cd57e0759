# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Hot pixels: few pixels leak charge."""

from collections.abc import Mapping

import numpy as np

from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.effects.base import Estimates, Parameter, SensorMap
from cg2raw.diagnose.effects.families import PEDESTAL, TEMPORAL, TIME
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern, share_interval
from cg2raw.diagnose.effects.sizes import percent, value_of
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.sensor import Sensor

HOT_PIXELS = "hot_pixels"


class HotPixels(FixedPattern):
    """Its value is the share of pixels that are hot; its map is of rates."""

    name = HOT_PIXELS
    title = "hot pixels"
    where = "few pixels far above the others, with exposure time"
    search = (Parameter("fraction", 0.0, 1.0),)
    families = frozenset({TEMPORAL, PEDESTAL})
    needs = TIME
    layout = "sparse"
    is_charge = True
    has_strength = False  # how many are hot is not how strong they are
    # The charge of a defect flickers by some percent of it.
    taken_up_by = {"random_telegraph_noise": 1e-3}
    told_apart = {
        "heavy_tailed_noise": "Several darks: hot pixels are the same ones in each and "
        "grow with exposure time; the tails of read noise fall on other pixels each "
        "time.",
    }

    def sensitivity(self, frame: Frame, photons: Array) -> float:
        return frame.seconds

    def share_beyond(
        self, parameters: Mapping[str, float], signal: float, seconds: float
    ) -> float:
        charge = parameters["rate"] * seconds
        return parameters["fraction"] * np.exp(-signal / charge) if charge > 0 else 0.0

    def standard_error(self, value: float, sensor_map: SensorMap) -> float:
        """Of a share of pixels, from their number."""
        count = sensor_map.mean.size
        return float(np.sqrt(max(value * (1 - value), 1 / count) / count))

    def interval(self, value: float, sensor_map: SensorMap) -> tuple[float, float]:
        return share_interval(value, sensor_map.mean.size)

    def registry_estimates(
        self, estimates: Estimates, sensor_map: SensorMap | None
    ) -> Estimates:
        """With the mean rate of those that are hot."""
        assert sensor_map is not None
        law, hot = sensor_map.rate_law, sensor_map.mean[sensor_map.mean > 0]
        rate = float(hot.mean()) if hot.size else 0.0
        if law is not None:
            rate = law.mean_of_few
        return {**estimates, "rate": Estimate(rate, "1/s", (rate, rate))}

    def size_in(self, values: Estimates, sensor: Sensor | None) -> str:
        return f"{percent(value_of(values, 'fraction'))} of the pixels are hot"


EFFECT = HotPixels()

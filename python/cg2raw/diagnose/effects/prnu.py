# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""PRNU: pixels of unequal gain."""

from collections.abc import Mapping

import numpy as np

from cg2raw.diagnose.effects.base import Estimates
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.effects.sizes import percent, value_of
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.sensor import Sensor


class Prnu(FixedPattern):
    name = "prnu"
    title = "PRNU"
    where = "the same pixels in all frames, in proportion to signal"

    def pattern_variance(
        self, stated: Mapping[str, float], light: Array, seconds: float
    ) -> Array:
        return np.asarray((stated["sigma"] * light) ** 2)

    def size_in(self, values: Estimates, sensor: Sensor) -> str:
        return f"standard deviation {percent(value_of(values, 'sigma'))} of the signal"


EFFECT = Prnu()

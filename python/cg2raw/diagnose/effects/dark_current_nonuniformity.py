# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Dark-current non-uniformity: charge gathers faster in some pixels than in others."""

from collections.abc import Mapping

import numpy as np

from cg2raw.diagnose.effects.base import Estimates
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.effects.sizes import of_white, value_of
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.sensor import Sensor


class DarkCurrentNonuniformity(FixedPattern):
    """Rates are log-normal, of the median of dark_current: `rate` is how much of that
    differs, `log_sigma` the standard deviation of its logarithm. Few pixels far above
    the others are hot_pixels."""

    name = "dark_current_nonuniformity"
    title = "dark-current non-uniformity"
    where = "the same pixels in all frames, with exposure time"
    told_apart = {
        "dsnu": "Darks of two exposure times: DSNU is the same in both, what charge "
        "leaves grows with time.",
        "hot_pixels": "Several long darks: hot pixels are few, far above the others; "
        "where dark current differs, all pixels do.",
        "dark_current": "Several long darks: dark current lifts all pixels alike.",
    }

    def pattern_variance(
        self, stated: Mapping[str, float], light: Array, seconds: float
    ) -> float:
        square = stated["log_sigma"] ** 2
        charge = stated["rate"] * seconds
        return float(charge**2 * np.exp(square) * np.expm1(square))

    def pattern_mean(self, stated: Mapping[str, float], seconds: float) -> float:
        beyond_median = np.expm1(stated["log_sigma"] ** 2 / 2)
        return float(stated["rate"] * seconds * beyond_median)

    def pattern_third_cumulant(
        self, stated: Mapping[str, float], seconds: float
    ) -> float:
        square = stated["log_sigma"] ** 2
        of_one = np.exp(1.5 * square) * np.expm1(square) ** 2 * (np.exp(square) + 2)
        return float((stated["rate"] * seconds) ** 3 * of_one)

    def size_in(self, values: Estimates, sensor: Sensor) -> str:
        rate = of_white(value_of(values, "rate"), sensor)
        spread = np.exp(value_of(values, "log_sigma"))
        return (
            f"{rate} per second of the dark current differ from pixel to pixel, by a "
            f"factor {spread:.3g}"
        )


EFFECT = DarkCurrentNonuniformity()

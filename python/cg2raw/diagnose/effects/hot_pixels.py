# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Hot pixels: few pixels leak charge."""

from cg2raw.diagnose.effects.base import Estimates
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.effects.sizes import of_white, percent, value_of
from cg2raw.sensor import Sensor


class HotPixels(FixedPattern):
    """Rates of a share of the pixels are exponential, of a mean; where darks show which
    they are, these pixels are masked."""

    name = "hot_pixels"
    title = "hot pixels"
    where = "few pixels far above the others, with exposure time"
    told_apart = {
        "heavy_tailed_noise": "Several darks: hot pixels are the same ones in each and "
        "grow with exposure time; the tails of read noise fall on other pixels each "
        "time.",
    }

    def size_in(self, values: Estimates, sensor: Sensor) -> str:
        rate = of_white(value_of(values, "rate"), sensor)
        share = percent(value_of(values, "fraction"))
        return f"{share} of the pixels are hot, by {rate} per second on average"


EFFECT = HotPixels()

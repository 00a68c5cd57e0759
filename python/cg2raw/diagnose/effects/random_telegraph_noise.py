# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Random telegraph noise: few pixels jump between two levels."""

from collections.abc import Mapping

from cg2raw.diagnose.effects.base import Estimates
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.effects.sizes import of_white, percent, value_of
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.sensor import Sensor


class RandomTelegraphNoise(FixedPattern):
    name = "random_telegraph_noise"
    title = "random telegraph noise"
    where = "few pixels, the same ones in all frames, jump from frame to frame"
    signature = frozenset({"noise", "map"})
    told_apart = {
        "heavy_tailed_noise": "Five or more repeated darks: telegraph noise is in the "
        "same pixels each time, the tails of read noise fall on others.",
        "hot_pixels": "Repeated darks of one exposure time: a hot pixel stays at its "
        "level, and a pixel of telegraph noise jumps between two.",
        "dsnu": "Repeated darks: an offset repeats, a jump does not.",
    }

    def pattern_variance(
        self, stated: Mapping[str, float], light: Array, seconds: float
    ) -> float:
        """Of pixels that jump by an exponential step, half of the time up."""
        return stated["fraction"] * stated["amplitude"] ** 2 / 2

    def size_in(self, values: Estimates, sensor: Sensor) -> str:
        amplitude = of_white(value_of(values, "amplitude"), sensor)
        return (
            f"{percent(value_of(values, 'fraction'))} of the pixels jump by "
            f"{amplitude} on average"
        )


EFFECT = RandomTelegraphNoise()

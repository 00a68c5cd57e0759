# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Random telegraph noise: few pixels jump between two levels."""

import numpy as np

from cg2raw.diagnose.effects.base import (
    Estimates,
    Parameter,
    SensorMap,
    Values,
    Whitened,
    WhiteningStage,
)
from cg2raw.diagnose.effects.families import TEMPORAL
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern, share_interval
from cg2raw.diagnose.effects.mixture import normal_score
from cg2raw.diagnose.effects.sizes import of_white, percent, value_of
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.sensor import Sensor

LEAST = 1e-12


class RandomTelegraphNoise(FixedPattern):
    """Its values are the share of pixels that jump and their mean step; its map is of
    their variance."""

    name = "random_telegraph_noise"
    title = "random telegraph noise"
    where = "few pixels, the same ones in all frames, jump from frame to frame"
    search = (Parameter("fraction", 0.0, 0.2), Parameter("amplitude", 0.0, 1.0))
    switches = ("fraction",)
    families = frozenset({TEMPORAL})
    signature = frozenset({"noise", "map"})
    layout = "jumps"
    measured_by_uniform_frames = False  # what is wrong with a mean would be in it
    whitening = WhiteningStage.JUMPS
    whitens_variance = True
    absorbs = True
    moves_mean = False
    # What a pixel is off that stood at one level in all fit frames, or in the longest.
    taken_up_by = {
        "hot_pixels": 0.12,
        "dsnu": 0.02,
        "prnu": 0.01,
        "column_fixed_pattern": 0.01,
    }
    has_strength = False  # how many jump is not how far they jump
    told_apart = {
        "heavy_tailed_noise": "Five or more repeated darks: telegraph noise is in the "
        "same pixels each time, the tails of read noise fall on others.",
        "hot_pixels": "Repeated darks of one exposure time: a hot pixel stays at its "
        "level, and a pixel of telegraph noise jumps between two.",
        "dsnu": "Repeated darks: an offset repeats, a jump does not.",
    }

    def whiten_by_map(
        self, z: Array, p: Prediction, sensor_map: SensorMap | None
    ) -> Whitened:
        """The normal score of a mixture: each pixel jumps by chance, or not."""
        if sensor_map is None or sensor_map.chance is None:
            return z, 0.0
        chance = np.clip(sensor_map.chance, LEAST, 1 - LEAST)
        extra = sensor_map.mean / chance
        if not np.any(extra):
            return z, 0.0
        return normal_score(z, chance, 1.0, 1 + extra / p.variance)

    def standard_errors(self, values: Values, sensor_map: SensorMap) -> list[float]:
        """By the information of pixels of which it is not known whether they jump.

        Source: T. A. Louis, J. R. Stat. Soc. B 44(2), 1982."""
        share, mean = np.maximum(values, LEAST)
        assert sensor_map.chance is not None
        chance = np.maximum(sensor_map.chance, LEAST)
        away = 2 * np.sqrt(sensor_map.mean / chance) / mean - 1
        of_share = (sensor_map.chance - share) / (share * (1 - share))
        of_mean = sensor_map.chance * away / mean
        told = ((of_share**2).sum(), (of_mean**2).sum())
        return [1 / float(np.sqrt(max(each, LEAST))) for each in told]

    def interval(self, value: float, sensor_map: SensorMap) -> tuple[float, float]:
        """Of as many pixels as would tell as much if it were known which ones jump."""
        error = self.standard_errors(np.array([value, 1.0]), sensor_map)[0]
        return share_interval(value, max(value, LEAST) / error**2)

    def size_in(self, values: Estimates, sensor: Sensor | None) -> str:
        amplitude = of_white(value_of(values, "amplitude"), sensor)
        return (
            f"{percent(value_of(values, 'fraction'))} of the pixels jump by "
            f"{amplitude} on average"
        )


EFFECT = RandomTelegraphNoise()

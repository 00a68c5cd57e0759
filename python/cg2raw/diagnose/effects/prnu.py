# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""PRNU: pixels of unequal gain."""

import numpy as np

from cg2raw.diagnose.effects.base import Estimates
from cg2raw.diagnose.effects.families import LIGHT_AGAIN
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.effects.sizes import percent, value_of
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.sensor import Sensor


class Prnu(FixedPattern):
    name = "prnu"
    title = "PRNU"
    where = "the same pixels in all frames, in proportion to signal"
    needs = LIGHT_AGAIN  # else either passes for the other
    lacks_slow_part = True
    has_long_tails = True
    # The slow part of the map, which the map leaves out.
    taken_up_by = {
        "color_shading": 0.01,
        "lens_shading": 0.01,
        "gr_gb_imbalance": 0.003,
    }

    def size_in(self, values: Estimates, sensor: Sensor | None) -> str:
        return f"standard deviation {percent(value_of(values, 'sigma'))} of the signal"

    def sensitivity(self, frame: Frame, photons: Array) -> Array:
        """Charge that gathers without light is none of a pixel's gain."""
        return photons if frame.capture.shows.light else np.zeros_like(photons)


EFFECT = Prnu()

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Dark current: charge that gathers with time."""

import numpy as np

from cg2raw.diagnose.effects.base import Effect, Estimates, Moments, Values
from cg2raw.diagnose.effects.families import PEDESTAL, TIME
from cg2raw.diagnose.effects.registry import listed_values
from cg2raw.diagnose.effects.sizes import value_of
from cg2raw.diagnose.frames.frame import DOUBLING
from cg2raw.sensor import Sensor

DARK_CURRENT = "dark_current"
# What else a colder sensor has less of, by its parameter; an amplifier's glow, where it
# is the warmth of the amplifier.
RATES = {
    "amplifier_glow": "per_second",
    "dark_current_nonuniformity": "rate",
    "hot_pixels": "rate",
}


class DarkCurrent(Effect):
    name = DARK_CURRENT
    title = "dark current"
    where = "grows with exposure time, in darks too"
    measured_by_uniform_frames = True
    step = 1e-4
    families = frozenset({PEDESTAL})
    signature = frozenset({"offset"})
    needs = TIME

    def from_moments(self, moments: Moments) -> Values:
        return np.array([moments.rate])

    def size_on(self, values: Estimates, sensor: Sensor) -> str:
        """With the profile's, if it states any: by how much the sensor is warmer."""
        text = self.size(values)
        listed = listed_values(sensor, self.name)
        stated = listed[0] if listed else 0.0
        ratio = ratio_to_stated(value_of(values, "per_second"), stated)
        if not stated or not ratio:
            return text
        kelvin = DOUBLING * np.log2(ratio)
        side = "warmer" if kelvin > 0 else "colder"
        return (
            f"{text}: {ratio:.3g} times the profile's, as of a sensor "
            f"{abs(kelvin):.1f} K {side} (twice as much every {DOUBLING:g} K)"
        )


def ratio_to_stated(found: float, stated: float) -> float:
    """Return the ratio of dark current, of which so much was found on top of what a
    profile states, to the profile's; 1 if that states none."""
    return max(1 + found / stated, 0.0) if stated else 1.0


EFFECT = DarkCurrent()

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Dark current: charge that gathers with time."""

import numpy as np

from cg2raw.diagnose.effects.base import Effect, Estimates
from cg2raw.diagnose.effects.registry import listed_values
from cg2raw.diagnose.effects.sizes import value_of
from cg2raw.sensor import Sensor
from cg2raw.statistics.temperature import DOUBLING


class DarkCurrent(Effect):
    name = "dark_current"
    title = "dark current"
    where = "grows with exposure time, in darks too"
    of_mean = False
    signature = frozenset({"offset"})
    told_apart = {
        "read_noise": "Darks of two exposure times: read noise is the same in both, "
        "that of dark current grows with time.",
    }

    @property
    def predicted(self) -> bool:
        return True

    def size_on(self, values: Estimates, sensor: Sensor) -> str:
        """With the profile's, if it states any: by how much the sensor is warmer."""
        text = self.size(values)
        listed = listed_values(sensor, self.name)
        ratio = value_of(values, "per_second") / listed[0] if listed else 0.0
        if ratio <= 0:
            return text
        kelvin = DOUBLING * np.log2(ratio)
        side = "warmer" if kelvin > 0 else "colder"
        return (
            f"{text}: {ratio:.3g} times the profile's, as of a sensor "
            f"{abs(kelvin):.1f} K {side} (twice as much every {DOUBLING:g} K)"
        )


EFFECT = DarkCurrent()

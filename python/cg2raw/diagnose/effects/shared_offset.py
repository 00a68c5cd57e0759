# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""SharedOffset: the family of offsets that pixels of a frame share, new in each."""

from typing import ClassVar

from cg2raw.diagnose.effects.base import (
    Effect,
    Estimates,
    Parameter,
    Values,
)
from cg2raw.diagnose.effects.registry import listed_values
from cg2raw.diagnose.effects.sizes import of_white, value_of
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.sensor import Sensor


class SharedOffset(Effect):
    """One normal number for a group of pixels. Its value is in read noises; the
    registry's is of white."""

    of_mean = False
    fitted: ClassVar[tuple[Parameter, ...]] = (Parameter("sigma", 0, 4),)
    step: ClassVar[float] = 0.01
    signature: ClassVar[frozenset[str]] = frozenset({"noise"})
    whitens_variance: ClassVar[bool] = True

    def offset_variance(self, values: Values, frame: Frame) -> float:
        return float(values[0] ** 2 * frame.beta2.mean())

    def sigma_in_effects(self, sensor: Sensor) -> float:
        """Return the standard deviation in a profile's effects, of white."""
        listed = listed_values(sensor, self.name)
        return listed[0] if listed else 0.0

    def size_on(self, values: Estimates, sensor: Sensor) -> str:
        return f"standard deviation {of_white(value_of(values, 'sigma'), sensor)}"

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""FixedPattern: the family of effects that darks and flats show, each in pixels of its
own; images take them as the profile states them."""

from collections.abc import Mapping
from typing import ClassVar

from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.effects.base import Effect, Estimates
from cg2raw.diagnose.effects.registry import listed_parameters, unit_of
from cg2raw.diagnose.effects.sizes import of_white, value_of
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.sensor import Sensor


class FixedPattern(Effect):
    """The same in all frames, and of each sensor its own: a profile states its law."""

    of_mean = False
    signature: ClassVar[frozenset[str]] = frozenset({"map"})

    def pattern_variance(
        self, stated: Mapping[str, float], light: Array, seconds: float
    ) -> Array | float:
        """Return the variance of what it adds to pixels, by its law, of signals of
        @light (T, h, w) and an exposure time: of offsets, if a sigma is stated."""
        return stated.get("sigma", 0.0) ** 2

    def pattern_mean(self, stated: Mapping[str, float], seconds: float) -> float:
        """Return the mean of what it adds to pixels in an exposure time."""
        return 0.0

    def pattern_third_cumulant(
        self, stated: Mapping[str, float], seconds: float
    ) -> float:
        """Return the third cumulant of what it adds, of signals cubed: 0 of what is as
        often above as below."""
        return 0.0

    def size_on(self, values: Estimates, sensor: Sensor) -> str:
        """With what the profile says, if it says anything."""
        stated = listed_parameters(sensor, self.name)
        if stated is None:
            return self.size_in(values, sensor)
        of_profile = {
            name: Estimate(value, unit_of(self.name, name, self.cfa), (value, value))
            for name, value in stated.items()
        }
        found, by_profile = (self.size_in(v, sensor) for v in (values, of_profile))
        return f"{found}; by the profile, {by_profile}"

    def size_in(self, values: Estimates, sensor: Sensor) -> str:
        """Return how strong it is by these values alone, in the sensor's units."""
        return f"standard deviation {of_white(value_of(values, 'sigma'), sensor)}"

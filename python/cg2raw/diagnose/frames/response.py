# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Response: how far a signal moves with the charge of its pixel.

The registry bends the signal x of charge to x - quadratic x^2 - cubic x^3: a map that
takes a tenth of the light takes less than that of a signal that is bent down.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cg2raw.diagnose.frames.tiling import Array

LAST_BEND = 1.3  # of white, from where on a signal is bent as there
NEWTON_STEPS_BACK = 3  # from a signal to its charge


@dataclass(frozen=True)
class Response:
    """A bent response, at signals (T, h, w)."""

    quadratic: float
    cubic: float
    signal: Array

    @classmethod
    def of(
        cls, values: Mapping[str, Sequence[float]], signal: Array
    ) -> "Response | None":
        """Return that of the registry's values; None if it is straight."""
        quadratic, cubic = values.get("nonlinearity", (0.0, 0.0))
        return cls(quadratic, cubic, signal) if quadratic or cubic else None

    @cached_property
    def charge(self) -> Array:
        """The signal as it was before, 0 at least."""
        x = np.maximum(self.signal, 0)
        for _ in range(NEWTON_STEPS_BACK):
            u = np.minimum(x, LAST_BEND)
            bent = x - u**2 * (self.quadratic + self.cubic * u)
            x = np.maximum(x - (bent - self.signal) / self._slope_at(x), 0)
        return x

    @cached_property
    def slope(self) -> Array:
        """How far the signal moves with its charge."""
        return self._slope_at(self.charge)

    def _slope_at(self, x: Array) -> Array:
        slope = 1 - x * (2 * self.quadratic + 3 * self.cubic * x)
        return np.where(x < LAST_BEND, slope, 1.0)

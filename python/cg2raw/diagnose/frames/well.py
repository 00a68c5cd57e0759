# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Well: what a full one cuts of charge: a normal charge is cut at a level."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import ndtr

from cg2raw.diagnose.frames.noise_model import LEAST_VARIANCE
from cg2raw.diagnose.frames.tiling import Array, Mask

FAR_FROM_LEVEL = (
    8.0  # standard deviations from the level, beyond which all or nothing is cut
)
NEAR_WELL = 6.0  # such deviations below the level, that its clipping is felt in
ROOT_2_PI = np.sqrt(2 * np.pi)


@dataclass(frozen=True)
class Well:
    """A level, and what fills up to it: charge and its variance, (T, h, w)."""

    level: float
    charge: Array
    variance: Array

    @classmethod
    def of(
        cls, values: Mapping[str, Sequence[float]], charge: Array, variance: Array
    ) -> "Well | None":
        """Return that of the registry's values; None if they have none."""
        below_white = values.get("full_well", [0.0])[0]
        return cls(1 - below_white, charge, variance) if below_white else None

    def is_near(self, variance: Array) -> Mask:
        """Return where charge of a variance (T, h, w) is near the level or above."""
        deviation = np.sqrt(np.maximum(variance, LEAST_VARIANCE))
        near: Mask = (self.level - self.charge) / deviation < NEAR_WELL
        return near

    @property
    def cut(self) -> Array:
        """What is lost of the mean, and of the variance, (2, T, h, w)."""
        lost = np.zeros((2, *self.charge.shape))
        near = self._near
        above, deviation = self._above(near)
        below = ndtr(-above)
        density = np.exp(-0.5 * above**2) / ROOT_2_PI
        short = density - above * below
        left = (1 + above**2) * below - above * density - short**2
        mean = self.charge[near] - self.level + deviation * short
        lost[0][near] = np.maximum(mean, 0)
        lost[1][near] = self.variance[near] * (1 - np.clip(left, 0, 1))
        return lost

    @cached_property
    def _near(self) -> Mask:
        """Where any charge is lost at all."""
        least = np.maximum(self.level - self.charge, 0) / FAR_FROM_LEVEL
        found: Mask = least**2 < np.maximum(self.variance, LEAST_VARIANCE)
        return found

    def _above(self, near: Mask) -> tuple[Array, Array]:
        """Return (how far charge is above the level, in standard deviations; these)."""
        deviation = np.sqrt(np.maximum(self.variance[near], LEAST_VARIANCE))
        above = (self.charge[near] - self.level) / deviation
        return np.minimum(above, FAR_FROM_LEVEL), deviation

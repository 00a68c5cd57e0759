# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Well: what a full one cuts of charge, as maps of the sensor fill it more or less.

A normal charge is cut at a level: the registry predicts that without maps, and a map
that takes a tenth of the light moves pixels from above the level to below it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from cg2raw.diagnose.frames.noise_model import LEAST_VARIANCE
from cg2raw.diagnose.frames.tiling import Array

FAR_FROM_LEVEL = (
    8.0  # standard deviations from the level, beyond which all or nothing is cut
)
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

    def with_more(self, charge: Array, variance: Array) -> "Well":
        more = np.maximum(self.variance + variance, 0)
        return Well(self.level, self.charge + charge, more)

    @property
    def _deviation(self) -> Array:
        return np.sqrt(np.maximum(self.variance, LEAST_VARIANCE))

    @property
    def _above(self) -> Array:
        return np.clip(
            (self.charge - self.level) / self._deviation,
            -FAR_FROM_LEVEL,
            FAR_FROM_LEVEL,
        )

    @property
    def below(self) -> Array:
        """The chance that charge stays below the level."""
        return np.asarray(ndtr(-self._above))

    @property
    def cut_mean(self) -> Array:
        """What is lost of the mean."""
        short = np.exp(-0.5 * self._above**2) / ROOT_2_PI - self._above * self.below
        lost = self.charge - self.level + self._deviation * short
        return np.asarray(np.maximum(lost, 0))

    @property
    def cut_variance(self) -> Array:
        """What is lost of the variance."""
        return np.asarray(self.variance * (1 - self.share_left))

    @property
    def share_left(self) -> Array:
        """The share of the variance that is left."""
        above, below = self._above, self.below
        density = np.exp(-0.5 * above**2) / ROOT_2_PI
        square = (1 + above**2) * below - above * density
        left = square - (density - above * below) ** 2
        return np.asarray(np.clip(left, 0, 1))

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""SharedOffset: the family of offsets that pixels of a frame share, new in each."""

from abc import abstractmethod
from collections.abc import Sequence
from functools import partial
from typing import ClassVar

import numpy as np

from cg2raw.diagnose.effects.base import (
    Effect,
    Estimates,
    Estimator,
    Gain,
    Parameter,
    Predicted,
    Values,
    Whitened,
)
from cg2raw.diagnose.effects.families import TEMPORAL
from cg2raw.diagnose.effects.registry import listed_values
from cg2raw.diagnose.effects.sizes import of_white, value_of
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.shrinkage import GroupCovariance
from cg2raw.diagnose.frames.tiling import Array, Tiling
from cg2raw.sensor import Sensor


class SharedOffset(Effect):
    """One normal number for a group of pixels: a covariance of rank one a group.

    Its value is in read noises; the registry's is of white."""

    estimator: ClassVar[Estimator] = "transform"
    search: ClassVar[tuple[Parameter, ...]] = (Parameter("sigma", 0, 4),)
    step: ClassVar[float] = 0.01
    families: ClassVar[frozenset[str]] = frozenset({TEMPORAL})
    signature: ClassVar[frozenset[str]] = frozenset({"noise"})
    absorbs: ClassVar[bool] = True
    moves_mean: ClassVar[bool] = False
    linear: ClassVar[bool] = True
    whitens_variance: ClassVar[bool] = True

    @abstractmethod
    def summed(self, tiles: Tiling, image: Array) -> Array:
        """Return sums over the pixels that share an offset, of an image (T, h, w), at
        each of them, or in a shape that is broadcast to them."""

    @abstractmethod
    def once(self, tiles: Tiling) -> Array | float:
        """Return what such sums are weighted by, so that each group counts once."""

    def offset_variance(self, values: Values, frame: Frame) -> float:
        return float(values[0] ** 2 * frame.beta2.mean())

    def along(self, p: Prediction, values: Values, frame: Frame) -> Array:
        """Return the offset's standard deviation in those of each pixel, (T, h, w)."""
        return frame.keep * np.sqrt(self.offset_variance(values, frame) / p.variance)

    def covariance(self, along: Array, frame: Frame) -> GroupCovariance:
        """Return that of residuals of a frame; along : as of `along`."""
        summed = partial(self.summed, frame.tiles)
        return GroupCovariance(along, summed, frame.keep)

    def leverage(self, along: Array, frame: Frame) -> Array:
        """Return the share of a pixel's variance that the likeliest offset of its group
        has of it."""
        return np.asarray(along**2 / (1 + self.summed(frame.tiles, along**2)))

    def whiten(
        self, z: Array, p: Prediction, values: Values, frame: Frame, read: Array
    ) -> Whitened:
        """Shrink the common offset of each group."""
        return self.covariance(self.along(p, values, frame), frame).whiten(z)

    def unit_scale(self, frames: Sequence[Frame]) -> float:
        if not frames:
            return 1.0
        return float(np.sqrt(np.mean([frame.beta2.mean() for frame in frames])))

    def expected_gain(
        self, selected: Predicted, fitted: Predicted, information: float
    ) -> Gain:
        told = [
            (self.summed(f.tiles, f.keep / p.variance), self.once(f.tiles))
            for f, p in selected
        ]

        def gain(sigma: float) -> float:
            return sum(
                float((w * (sigma**2 * t - np.log1p(sigma**2 * t))).sum()) / 2
                for t, w in told
            )

        return gain

    def sigma_in_effects(self, sensor: Sensor) -> float:
        """Return the standard deviation in a profile's effects, of white."""
        listed = listed_values(sensor, self.name)
        return listed[0] if listed else 0.0

    def size(self, values: Estimates) -> str:
        return f"standard deviation {of_white(value_of(values, 'sigma'), None)}"

    def size_on(self, values: Estimates, sensor: Sensor) -> str:
        return f"standard deviation {of_white(value_of(values, 'sigma'), sensor)}"

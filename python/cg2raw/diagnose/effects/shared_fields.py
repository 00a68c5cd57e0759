# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""SharedFields: the family of fields of light that a frame has by normal numbers of
its own."""

from abc import abstractmethod

import numpy as np

from cg2raw.diagnose.effects.base import Effect, Values, Whitened
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.shrinkage import shown_light, whitener_along
from cg2raw.diagnose.frames.tiling import Array


class SharedFields(Effect):
    """A covariance of a rank of few for all pixels of a frame."""

    linear = True
    whitens_variance = True

    @abstractmethod
    def light(self, values: Values, frame: Frame) -> list[Array]:
        """Return the fields of independent normal numbers of variance 1, each relative
        to the light and broadcast to (T, h, w); none of a frame that has none."""

    def fields(self, p: Prediction, values: Values, frame: Frame) -> list[Array]:
        """Return them in standard deviations of a pixel, as far as pixels show them."""
        fields = self.light(values, frame)
        if not fields:
            return []
        sensitivity = shown_light(frame, p) / np.sqrt(p.variance)
        return [field * sensitivity for field in fields]

    def whiten(
        self, z: Array, p: Prediction, values: Values, frame: Frame, read: Array
    ) -> Whitened:
        """Shrink a frame's fields."""
        return whitener_along(self.fields(p, values, frame), frame)(z)

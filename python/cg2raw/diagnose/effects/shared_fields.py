# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""SharedFields: the family of fields that a frame has by normal numbers of its own."""

from abc import abstractmethod

from cg2raw.diagnose.effects.base import Effect, Values, Whitened
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.shrinkage import whitener_along
from cg2raw.diagnose.frames.tiling import Array


class SharedFields(Effect):
    """A covariance of a rank of few for all pixels of a frame."""

    linear = True
    whitens_variance = True

    @abstractmethod
    def fields(self, p: Prediction, values: Values, frame: Frame) -> list[Array]:
        """Return the fields of independent normal numbers of variance 1, each (T, h, w)
        in standard deviations of a pixel; none of a frame that does not show them."""

    def whiten(
        self, z: Array, p: Prediction, values: Values, frame: Frame, read: Array
    ) -> Whitened:
        """Shrink a frame's fields."""
        return whitener_along(self.fields(p, values, frame), frame)(z)

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Shrinkage: what is Gaussian of few dimensions is integrated out of residuals."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array, Mask

LEAST_EIGENVALUE = 1e-6  # of the largest


@dataclass(frozen=True)
class Shrinkage:
    """Shrinks residuals along fields. columns : (k, pixels) of them; None for none.
    shrink : (k, k) along these. cost : log of the determinant, per pixel."""

    columns: Array | None
    shrink: Array
    cost: float

    @classmethod
    def along(cls, columns: Array | None, keep: Mask) -> "Shrinkage":
        """Return what whitens residuals of covariance 1 + columns.T @ columns.

        columns : (k, pixels) fields, in standard deviations of a pixel, 0 where keep is
            False. keep : pixels that share the cost."""
        if columns is None or not columns.any():
            return cls(None, np.zeros((0, 0)), 0.0)
        values, vectors = np.linalg.eigh((columns @ columns.T).astype(float))
        used = values > LEAST_EIGENVALUE * max(values[-1], 1e-3)
        weight = (1 - (1 + values[used]) ** -0.5) / values[used]
        shrink = (vectors[:, used] * weight) @ vectors[:, used].T
        cost = -0.5 * np.log1p(values[used]).sum() / max(keep.sum(), 1)
        return cls(columns, shrink, float(cost))

    def apply(self, z: Array, keep: Mask) -> tuple[Array, Array | float]:
        """Return residuals whose fields are shrunk, and the cost per pixel."""
        if self.columns is None:
            return z, 0.0
        flat, kind = z.ravel(), self.columns.dtype
        along = self.shrink @ (self.columns @ flat.astype(kind))
        shrunk = flat - along.astype(kind) @ self.columns
        return shrunk.reshape(z.shape), self.cost * keep


class GroupCovariance:
    """The covariance 1 + along along^T of the residuals of each group of pixels, of
    which `whiten` leaves 1."""

    def __init__(
        self, along: Array, summed: Callable[[Array], Array], keep: Mask
    ) -> None:
        """along : (T, h, w), in standard deviations of a pixel, 0 where keep is False.
        summed : returns sums of an image over the pixels of a group, at each of them,
        or in a shape that is broadcast to them. keep : pixels that share the cost."""
        self._summed, self._keep = summed, keep
        self._square = summed(along * along) + 1e-300
        self._unit = along / np.sqrt(self._square)

    def whiten(self, z: Array) -> tuple[Array, Array]:
        """Return residuals (T, h, w) without what they share, and the log of the
        determinant of that, per pixel."""
        return z - self._shrinking * self._summed(self._unit * z), self._cost

    def colour(self, z: Array) -> Array:
        """Return z such that its product with what `whiten` makes of an image is that
        of z with the image."""
        more = np.sqrt(1 + self._square) - 1
        return z + more * self._unit * self._summed(self._unit * z)

    @cached_property
    def _shrinking(self) -> Array:
        return np.asarray((1 - (1 + self._square) ** -0.5) * self._unit)

    @cached_property
    def _cost(self) -> Array:
        count = np.maximum(self._summed(self._keep.astype(float)), 1)
        return np.asarray(-0.5 * np.log1p(self._square) / count * self._keep)


def whitener_along(
    fields: Sequence[Array], frame: Frame
) -> Callable[[Array], tuple[Array, Array | float]]:
    """Return what takes fields (T, h, w), in standard deviations of a pixel, that a
    frame has by normal numbers, out of residuals of the same shape, and returns these
    and the cost per pixel."""
    columns = np.reshape(fields, (len(fields), -1)) if fields else None
    return partial(Shrinkage.along(columns, frame.keep).apply, keep=frame.keep)


def shown_light(frame: Frame, p: Prediction) -> Array:
    """Return the light (T, h, w) whose change pixels show: none where they are clipped,
    or do not count, and in darks, whose charge is none of light."""
    if not frame.capture.shows.light:
        return np.zeros_like(p.exposed)
    shows = frame.keep & ~frame.censored
    light: Array = np.where(shows, p.below * np.maximum(p.exposed, 0), 0)
    return light

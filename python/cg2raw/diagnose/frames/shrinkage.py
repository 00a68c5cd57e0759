# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Shrinkage: what is Gaussian of few dimensions is integrated out of residuals."""

from collections.abc import Sequence
from dataclasses import dataclass

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


def whiten_along(
    z: Array, fields: Sequence[Array], frame: Frame
) -> tuple[Array, Array | float]:
    """Return residuals (T, h, w) without fields of the same shape, in standard
    deviations of a pixel, that a frame has by normal numbers, and the cost per
    pixel."""
    if not fields:
        return z, 0.0
    columns = np.reshape(fields, (len(fields), -1))
    return Shrinkage.along(columns, frame.keep).apply(z, frame.keep)


def shown_light(frame: Frame, p: Prediction) -> Array:
    """Return the light (T, h, w) whose change pixels show: none where they are clipped,
    or do not count, and in darks, whose charge is none of light."""
    if not frame.capture.shows.light:
        return np.zeros_like(p.exposed)
    shows = frame.keep & ~frame.censored
    light: Array = np.where(shows, p.below * np.maximum(p.exposed, 0), 0)
    return light

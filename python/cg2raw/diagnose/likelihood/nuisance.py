# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Nuisances: what is wrong with a capture and not with the camera.

Light that flickers from frame to frame, and a render's smooth error of radiance, are
Gaussian fields of few dimensions: they are integrated out, not fitted. What is left of
a wrong registration is a variance on edges. None of it is written to a profile.
"""

from dataclasses import dataclass

import numpy as np

from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.shrinkage import Shrinkage, shown_light
from cg2raw.diagnose.frames.tiling import Array

FIELD = (5, 6)  # bumps of a smooth error, down and across a frame
WIDTH_OF_BUMP = 0.7  # of their distance, standard deviation
BUMPS_THAT_ADD = 1.6  # how many of their variances a pixel sees
UNSURE_HIGHLIGHT = 0.15  # relative, of light there
UNKNOWN_LEVEL = 0.3  # relative, of what nobody measured
AFTER_ALIGNMENT = 0.05  # relative, of an exposure that was estimated


@dataclass(frozen=True)
class Nuisance:
    """Standard deviations: of a frame's brightness and of a smooth error, relative; of
    a shift, px; of fine texture, and of a patch's colour, relative. free: which of them
    are free at all.
    apart : the tables of a chart are taken one by one, as they are to say how large the
    errors of its colours are. Else each has that error as often as there are tables, so
    that all of them together know no more of it than one."""

    light: float
    radiance: float
    registration: float
    texture: float
    free: frozenset[str]
    apart: bool = False

    def pixel_variance(self, frame: Frame, variance: Array) -> Array | float:
        """Return what is independent from pixel to pixel."""
        if not frame.capture.shows.image:
            return 0.0
        slope, light = frame.squared_slope_and_light
        if frame.samples is not None:
            of_chart = self.texture**2 * (1 if self.apart else frame.repeats)
            return (of_chart + frame.censored * AFTER_ALIGNMENT**2) * light
        extra = self.registration**2 * slope + self.texture**2 * light
        whole = self.light**2 + BUMPS_THAT_ADD * self.radiance**2
        if frame.highlights is not None:
            extra = extra + frame.highlights * UNSURE_HIGHLIGHT**2 * light
        return extra + frame.censored * whole * light

    def levels(self, frame: Frame) -> list[Array | float]:
        """Return how unsure a frame's light is, as fields of independent normal numbers
        of variance 1, each relative and broadcast to (T, h, w): of its colours, and of
        all of it."""
        if not frame.capture.shows.light:
            return []
        is_chart = frame.samples is not None  # whose colour is known, if not its light
        apart = frame.level_free and not is_chart or "white_balance" in self.free
        unknown = UNKNOWN_LEVEL if frame.level_free else AFTER_ALIGNMENT
        fields = [unknown * (frame.color == c) for c in range(3)] if apart else []
        brightness = self.light
        if "exposure" in self.free:
            brightness = np.hypot(brightness, AFTER_ALIGNMENT)
        if frame.level_free and is_chart:
            brightness = np.hypot(brightness, UNKNOWN_LEVEL)
        return [*fields, brightness]

    def _columns(self, frame: Frame, p: Prediction) -> Array | None:
        """(k, pixels) of the fields, in standard deviations of a pixel."""
        levels = self.levels(frame)
        if not levels:
            return None
        sensitivity = (shown_light(frame, p) / np.sqrt(p.variance)).astype("f4")
        columns = [level * sensitivity for level in levels]
        is_chart = frame.samples is not None
        if frame.capture.shows.image and not is_chart and "radiance" in self.free:
            down, across = _bumps(frame)
            rows = [self.radiance * sensitivity * down[..., i] for i in range(FIELD[0])]
            columns += [row * across[..., j] for row in rows for j in range(FIELD[1])]
        return np.array([column.ravel() for column in columns], "f4")

    def shrinkage(self, p: Prediction, frame: Frame) -> Shrinkage:
        """Return what integrates the fields out of residuals of a prediction."""
        return Shrinkage.along(self._columns(frame, p), frame.keep)


def _bumps(frame: Frame) -> tuple[Array, Array]:
    """Return Gaussian bumps along rows (T, h, 1, n) and columns (T, 1, w, n)."""
    parts = []
    for places, length, count in zip(
        frame.tiles.rows_and_columns(), frame.tiles.shape, FIELD, strict=True
    ):
        distance = places[..., None] / length * (count - 1) - np.arange(count)
        parts.append(np.exp(-0.5 * (distance / WIDTH_OF_BUMP) ** 2).astype("f4"))
    down, across = parts
    return down, across

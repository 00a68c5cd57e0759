# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Lens shading: light falls off towards the corners."""

import numpy as np
from numpy.typing import NDArray

from cg2raw.diagnose.diagnosis import Curve
from cg2raw.diagnose.effects.base import (
    GAIN,
    LIGHT,
    Effect,
    Estimates,
    MeasuredRatio,
    Values,
    percent,
    value_of,
)
from cg2raw.diagnose.effects.interval_curve import CURVE_POINTS, curve_with_interval
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.sensor import Sensor

CURVE_RINGS = 20
SHAPE = (2, 3)  # of a frame whose sensor is not known
CORNERS = ("top left", "top right", "bottom left", "bottom right")


class LensShading(Effect):
    name = "lens_shading"
    title = "lens shading"
    where = "falls off with radius, all channels, in proportion to signal"
    measured_by_uniform_frames = True
    step = 2e-3
    families = frozenset({GAIN})
    signature = frozenset({"gain"})
    needs = LIGHT
    # Vignetting that is no polynomial; a lamp's light, which differs from flat to flat
    # by some thousandths of it.
    taken_up_by = {
        "exposure": 1e-4,
        "prnu": 5e-5,
        "dust": 2e-3,
        "mains_flicker": 1e-4,
    }
    told_apart = {
        "veiling_glare": "Flats at two levels and a scene with a bright area: glare "
        "adds to dark regions what the bright ones give, shading multiplies.",
    }

    def size(self, values: Estimates) -> str:
        loss = max(corner_losses(values, SHAPE))
        verb = "loses" if loss >= 0 else "gains"
        return f"the lens {verb} {percent(abs(loss))} at the darkest corner"

    def size_on(self, values: Estimates, sensor: Sensor) -> str:
        losses = corner_losses(values, (sensor.height, sensor.width))
        listed = ", ".join(
            f"{corner} {percent(loss)}"
            for corner, loss in zip(CORNERS, losses, strict=True)
        )
        return f"the lens loses light in the corners: {listed}"

    def curve(
        self, values: Values, estimates: Estimates, measured: MeasuredRatio
    ) -> Curve:
        r = np.linspace(0, 1, CURVE_POINTS)
        design = np.zeros((CURVE_POINTS, len(values)))
        design[:, :3] = np.stack([r**2, r**4, r**6], 1)
        x, y = measured(_ring, CURVE_RINGS)
        return Curve(
            "Vignetting",
            "radius, 1 in the corner",
            "relative illumination",
            r,
            *curve_with_interval(values, estimates, design),
            (x + 0.5) / CURVE_RINGS,
            y,
            self.name,
        )


def _ring(frame: Frame, p: Prediction) -> NDArray[np.int64]:
    u, v = frame.tiles.field()
    rings: NDArray[np.int64] = (np.hypot(u, v) * CURVE_RINGS).astype(int)
    return np.minimum(rings, CURVE_RINGS - 1)


def corner_losses(values: Estimates, shape: tuple[int, int]) -> list[float]:
    """Return the loss of light in the CORNERS of a frame (H, W), relative to that in
    its middle; below 0 where there is more."""
    r2, r4, r6, *tilts = (
        value_of(values, n)
        for n in ("r2", "r4", "r6", "tilt_x", "tilt_y", "tilt_x_r2", "tilt_y_r2")
    )
    x, y, x2, y2 = tilts
    v, u = np.array(shape) / np.hypot(*shape)  # of a corner, in half diagonals
    return [
        float(-(r2 + r4 + r6 + right * u * (x + x2) + down * v * (y + y2)))
        for down in (-1, 1)
        for right in (-1, 1)
    ]


EFFECT = LensShading()

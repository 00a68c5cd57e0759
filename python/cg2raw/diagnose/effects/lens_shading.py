# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Lens shading: light falls off towards the corners."""

from collections.abc import Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from cg2raw.diagnose.diagnosis import Curve
from cg2raw.diagnose.effects.base import Effect, Estimates, MeasuredRatio, Values
from cg2raw.diagnose.effects.interval_curve import CURVE_POINTS, curve_with_interval
from cg2raw.diagnose.effects.sizes import percent, value_of
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.sensor import Sensor

CURVE_RINGS = 20
# Of a lens that is not round, by the power of the radius and the number of times that
# it goes up and down around its centre: all that are left of powers up to the sixth.
TURNING = {
    f"r{power}_{wave}{angles}": (power, angles, wave)
    for power in range(2, 7)
    for angles in range(power, 0, -2)
    if (power, angles) != (3, 1)
    for wave in ("cos", "sin")
}
MORE_FLATS = (
    "More flats: their mean tells what falls off from the middle, as shading does, "
    "from what is the same all over."
)
SAME_ALL_OVER = (
    "exposure",
    "white_balance",
    "gr_gb_imbalance",
    "crosstalk",
    "nonlinearity",
)
CORNERS = ("top left", "top right", "bottom left", "bottom right")


class LensShading(Effect):
    name = "lens_shading"
    title = "lens shading"
    where = "falls off with radius, all channels, in proportion to signal"
    step = 2e-3
    signature = frozenset({"gain"})
    # Vignetting that is no polynomial.
    taken_up_by = dict.fromkeys(
        ("exposure", "amplifier_mismatch", "bias_structure"), 1e-4
    )
    told_apart = {
        "veiling_glare": "Flats at two levels and a scene with a bright area: glare "
        "adds to dark regions what the bright ones give, shading multiplies.",
        **dict.fromkeys(SAME_ALL_OVER, MORE_FLATS),
    }

    def size_on(self, values: Estimates, sensor: Sensor) -> str:
        return corner_words(corner_losses(values, (sensor.height, sensor.width)))

    def curve(
        self, values: Values, estimates: Estimates, measured: MeasuredRatio
    ) -> Curve:
        r = np.linspace(0, 1, CURVE_POINTS)
        design = np.stack([r**2, r**4, r**6], 1)
        radial = {name: estimates[name] for name in self.parameters[:3]}
        x, y = measured(_ring, CURVE_RINGS)
        return Curve(
            "Vignetting",
            "radius, 1 in the corner",
            "relative illumination",
            r,
            *curve_with_interval(values[:3], radial, design),
            (x + 0.5) / CURVE_RINGS,
            y,
            self.name,
        )


def _ring(frame: Frame, p: Prediction) -> NDArray[np.int64]:
    u, v = frame.tiles.field()
    rings: NDArray[np.int64] = (np.hypot(u, v) * CURVE_RINGS).astype(int)
    return np.minimum(rings, CURVE_RINGS - 1)


def corner_words(losses: Sequence[float]) -> str:
    """Return what the CORNERS lose or gain, each of them."""
    gains = max(losses) < 0
    verb = "gains" if gains else "loses"
    listed = ", ".join(
        f"{corner} {percent(-loss if gains else loss)}"
        for corner, loss in zip(CORNERS, losses, strict=True)
    )
    more = "; below 0, a corner gains" if min(losses) < 0 <= max(losses) else ""
    return f"the lens {verb} light in the corners: {listed}{more}"


def corner_losses(values: Estimates, shape: tuple[int, int]) -> list[float]:
    """Return the loss of light in the CORNERS of a frame (H, W), relative to that in
    its middle; below 0 where there is more."""
    v, u = np.array(shape) / np.hypot(*shape)  # of a corner, in half diagonals
    even = sum(value_of(values, name) for name in ("r2", "r4", "r6"))
    x, y = (
        value_of(values, f"tilt_{axis}") + value_of(values, f"tilt_{axis}_r2")
        for axis in "xy"
    )
    losses = []
    for down, right in product((-1, 1), repeat=2):
        gain = even + right * u * x + down * v * y
        radius, angle = np.hypot(right * u, down * v), np.arctan2(down * v, right * u)
        for name, (power, angles, wave) in TURNING.items():
            turned = {"cos": np.cos, "sin": np.sin}[wave](angles * angle)
            gain += value_of(values, name) * (radius**power * turned)
        losses.append(float(-gain))
    return losses


EFFECT = LensShading()

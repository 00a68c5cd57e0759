# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""One sensor under one illuminant as a chain of OCIO transforms, exact, without a LUT.

Every function returns a list of PyOpenColorIO transforms (OpenColorIO 2.1 to 2.6).
The chains compute what `CameraTransform` of the core says:

    balanced = clip(second clip(first scene)), camera = highlights(balanced, gains)

and then, where the sensor has effects of stage color, (3, 3) color_effects camera.
They drop alpha (it comes out 1): on the way they keep a colour channel there."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import PyOpenColorIO as ocio
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:  # chains are made where there is no cg2raw, too
    from cg2raw._core import CameraTransform

# Of PyOpenColorIO, which has no annotations: a transform, a colour space, a config.
Op = Any
Space = Any
Config = Any
Array = NDArray[np.float64]
# Of the four channels: (4,) coefficients and an offset.
Form = tuple[Array, float]

# Radiance beyond this is infinite, as in the core.
LARGEST_RADIANCE = 1e6
# What infinities and NaN become first, so that no product of them with 0 is NaN again.
# Below 1e16: OpenColorIO writes a whole number beyond that into a shader as "1e+16.",
# which no GLSL compiler reads.
FAR_OUT = 2.0**50
# Where highlights begin to lose their colour. Source: Brooks et al., CVPR 2019.
HIGHLIGHT_START = 0.9
# Of each channel in the others, so that FAR_OUT outweighs LARGEST_RADIANCE in all; too
# little for the rounding of float32.
LEAK = 2.0**-29


def camera_from_scene(
    transform: "CameraTransform", color_effects: Array | None = None
) -> list[Op]:
    """Linear Rec.709 -> camera RGB, highlights kept white.

    A pixel with NaN in any channel becomes black; +inf becomes white."""
    ops = legal() + clipped_product(transform.first)
    if transform.two_steps:
        ops += clipped_product(transform.second)
    if transform.keep_highlights:
        ops = ops[:-1] + unbalanced(transform.gains)
    else:
        ops += [matrix(np.diag(transform.gains))]
    ops += [clip()] if transform.clip_result else []
    return ops + ([] if color_effects is None else [matrix(color_effects)])


def scene_from_camera(
    transform: "CameraTransform", color_effects: Array | None = None
) -> list[Op]:
    """Camera RGB -> linear Rec.709, as a camera's image processor does it: white
    balance, clip at white, colour matrix; after the inverse of the effects. Highlights
    come out white, not brighter."""
    ops = [] if color_effects is None else [matrix(np.linalg.inv(color_effects))]
    ops += [matrix(np.diag(1.0 / np.asarray(transform.gains))), clip()]
    if transform.two_steps:
        ops += clipped_product(np.linalg.inv(transform.second))
    return ops + [matrix(np.linalg.inv(transform.first))]


def camera_from_scene_unbounded(
    transform: "CameraTransform", color_effects: Array | None = None
) -> list[Op]:
    """The same colours as one matrix, which never clips and has an exact inverse.
    Highlights take the colour of the light."""
    balanced = transform.second @ transform.first
    camera = np.diag(transform.gains) @ balanced
    return [matrix(camera if color_effects is None else color_effects @ camera)]


def matrix(rows: ArrayLike, offset: Sequence[float] = (0.0, 0.0, 0.0, 0.0)) -> Op:
    """A 3x3 or 4x4 matrix and an offset of R, G, B, A."""
    full = np.eye(4)
    rows = np.asarray(rows, float)
    full[: len(rows), : len(rows)] = rows
    transform = ocio.MatrixTransform()
    transform.setMatrix([_rounded(value) for value in full.ravel()])
    transform.setOffset([_rounded(value) for value in offset])
    return transform


def _rounded(value: float) -> float:
    """To 12 digits, which every NumPy and OpenColorIO computes and writes alike."""
    return float(f"{value:.12g}")


def clip(low: float = 0.0, high: float = 1.0, shift: float = 0.0) -> Op:
    """Clamp R, G, B, then add shift; NaN counts as low."""
    transform = ocio.RangeTransform()
    transform.setMinInValue(low)
    transform.setMinOutValue(low + shift)
    transform.setMaxInValue(high)
    transform.setMaxOutValue(high + shift)
    return transform


def clipped_product(rows: ArrayLike) -> list[Op]:
    """A matrix and a clip to 0..1."""
    return [matrix(rows), clip()]


def legal() -> list[Op]:
    """Finite pixels: NaN in one channel is black in all, infinity white."""
    return [
        clip(-FAR_OUT, FAR_OUT),
        matrix(np.eye(3) + LEAK),
        clip(-LARGEST_RADIANCE, LARGEST_RADIANCE),
    ]


def unbalanced(gains: ArrayLike) -> list[Op]:
    """Balanced camera RGB, clipped to 0..1, times max(m + (1 - m) g, g) with the mask
    m = max(mean(R, G, B) - 0.9, 0)^2 / 0.1^2: white balance undone, white kept white.

    See product() for how two channels are multiplied."""
    gains = np.asarray(gains, float)
    # Above 1, max(m + (1 - m) g, g) is g.
    todo = sorted((c for c in range(3) if gains[c] < 1.0), key=lambda c: gains[c])
    late = np.diag(np.maximum(gains, 1.0))
    if not todo:
        return [clip(), matrix(late)]
    state = _Channels(parked=next((c for c in (1, 0, 2) if c not in todo), 1))
    ops = state.begin()
    for channel in todo:
        ops += state.multiply(channel, gains[channel])
    return ops + state.end(late)


class _Channels:
    """Where R, G, B (0, 1, 2) and the mask are on their way: each is a linear form
    (4 coefficients, offset) of the four channels that OCIO passes on."""

    def __init__(self, parked: int) -> None:
        self.parked = parked
        self.first, self.last = (c for c in range(3) if c != parked)
        self.form: dict[int | str, Form] = {}

    def begin(self) -> list[Op]:
        """Balanced RGB -> (first, mask, last, parked), the colours less 0.9: there the
        mask starts, and a sum of differences keeps the digits."""
        unit = np.eye(4)
        rows = np.zeros((4, 4))
        rows[0, self.first] = rows[2, self.last] = rows[3, self.parked] = 1.0
        rows[1, :3] = 1.0 / (3.0 * (1.0 - HIGHLIGHT_START))
        slots: tuple[int | str, ...] = (self.first, "mask", self.last, self.parked)
        self.form = {name: (unit[i], HIGHLIGHT_START) for i, name in enumerate(slots)}
        self.form["mask"] = (unit[1], 0.0)
        return [clip(shift=-HIGHLIGHT_START), matrix(rows), squared_green()]

    def multiply(self, channel: int, gain: float) -> list[Op]:
        """channel *= (1 - gain) mask + gain."""
        others = [c for c in (self.first, self.last, self.parked) if c != channel]
        carried, aside = sorted(others, key=lambda c: c == self.parked)
        mask, offset = self.form["mask"]
        scale = ((1.0 - gain) * mask, (1.0 - gain) * offset + gain)
        carry = (self.form[carried][0], self.form[carried][1] + 1.0)
        ops = product(self.form[channel], carry, scale, self.form[aside])
        unit = np.eye(4)
        self.form = {
            channel: (unit[0], 0.0),
            "mask": (unit[1] / (1.0 - gain), -gain / (1.0 - gain)),
            carried: (unit[0] + unit[1] + unit[2], -1.0),
            aside: (unit[3], 0.0),
        }
        return ops

    def end(self, late: Array) -> list[Op]:
        """Back to R, G, B in order, times the gains above 1; alpha 1."""
        rows = np.stack([self.form[c][0] for c in range(3)])
        offset = np.array([self.form[c][1] for c in range(3)])
        full = np.vstack([late @ rows, np.zeros(4)])
        return [matrix(full, (*(late @ offset), 1.0))]


def product(x: Form, y: Form, z: Form, aside: Form) -> list[Op]:
    """(x z, z, y - x z - z, aside) of four linear forms of R, G, B, A; y must not be 0.

    A product of two channels is two inverse XYZ_TO_xyY: (x, y, Y) becomes
    (x Y / y, Y, Y / y - x Y / y - Y), and with (X, X + Y + Z, Y) as the next (x, y, Y)
    the first channel is x Y; y comes back as X + Y + Z."""
    again = np.eye(4)
    again[:3] = [[1, 0, 0, 0], [1, 1, 1, 0], [0, 1, 0, 0]]
    return [forms(x, y, z, aside), xyz_from_xyy(), matrix(again), xyz_from_xyy()]


def forms(*rows: Form) -> Op:
    """The matrix of four linear forms."""
    return matrix(np.stack([row[0] for row in rows]), [row[1] for row in rows])


def xyz_from_xyy() -> Op:
    """(x, y, Y) -> (x Y / y, Y, (1 - x - y) Y / y)."""
    transform = ocio.FixedFunctionTransform(ocio.FIXED_FUNCTION_XYZ_TO_xyY)
    transform.setDirection(ocio.TRANSFORM_DIR_INVERSE)
    return transform


def squared_green() -> Op:
    """G -> max(G, 0)^2 for G up to 1; R and B stay.

    A quadratic B-spline of one segment is the parabola itself. Read from YAML, because
    the Python module of OpenColorIO 2.1 cannot set a curve's slopes."""
    [space] = ocio.Config.CreateFromStream(SQUARED_GREEN).getColorSpaces()
    return space.getTransform(ocio.COLORSPACE_DIR_FROM_REFERENCE)


SQUARED_GREEN = """\
ocio_profile_version: 2
roles: {default: squared_green}
colorspaces:
  - !<ColorSpace>
    name: squared_green
    from_scene_reference: !<GradingRGBCurveTransform>
      style: log
      green: {control_points: [0, 0, 1, 1], slopes: [0, 2]}
"""

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Colour and optics of hidden effects: camera RGB to the light on the sensor."""

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np
from numpy.random import Generator
from scipy import fft
from scipy.ndimage import map_coordinates
from scipy.special import j1

from cg2raw.synthetic.camera import Camera, Plane

Values = Mapping[str, float]
Hidden = Mapping[str, Values]


class Field:
    """Places of a frame that is seen with a margin around it.

    x, y : px from the frame's centre. corner : half its diagonal, px. inner : slices
    that cut the margin off."""

    def __init__(self, shape: tuple[int, int], margin: int) -> None:
        height, width = shape
        rows, cols = np.mgrid[-margin : height + margin, -margin : width + margin]
        self.y: Plane = rows - (height - 1) / 2
        self.x: Plane = cols - (width - 1) / 2
        self.corner = float(np.hypot((height - 1) / 2, (width - 1) / 2))
        self.shape = shape
        self.margin = margin
        self.inner = (slice(margin, margin + height), slice(margin, margin + width))

    def radius(self, axis_x: float = 0.0, axis_y: float = 0.0) -> Plane:
        """Return distances from an optical axis, both in half diagonals."""
        return np.hypot(self.x / self.corner - axis_x, self.y / self.corner - axis_y)

    def moved(self, plane: Plane, dx: Plane, dy: Plane) -> Plane:
        """Return what stands at (x + dx, y + dy), by cubic splines; not negative."""
        rows, cols = np.mgrid[: plane.shape[0], : plane.shape[1]]
        at = [rows + dy, cols + dx]
        there: Plane = map_coordinates(plane, at, order=3, mode="mirror")
        return np.maximum(there, 0.0)


def filtered(plane: Plane, otf: Callable[[Plane], Plane]) -> Plane:
    """Return a plane, mirrored at its edges, filtered by otf(cycles per px)."""
    height, width = plane.shape
    v = np.arange(height)[:, None] / (2 * height)
    u = np.arange(width)[None] / (2 * width)
    passed: Plane = fft.idctn(fft.dctn(plane, type=2) * otf(np.hypot(u, v)), type=2)
    return passed


def recolored(scene: Plane, hidden: Hidden) -> Plane:
    """Return scene-linear Rec.709 as another colorimetry sees it; greys stay.

    A saturation about grey, a turn of the hue about the grey axis, and a red that is
    taken for green."""
    values = hidden.get("color_matrix")
    if values is None:
        return scene
    grey = np.full((3, 3), 1 / 3)
    cross = np.array([[0, -1, 1], [1, 0, -1], [-1, 1, 0]]) / np.sqrt(3)
    turn = values["hue"]
    chroma = np.eye(3) - grey
    matrix: Plane = grey + (1 + values["saturation"]) * (
        np.cos(turn) * chroma + np.sin(turn) * cross
    )
    matrix = matrix + values["red_as_green"] * np.outer([0, 1, 0], [1, -0.5, -0.5])
    return scene @ matrix.T


def gained(camera_rgb: Plane, hidden: Hidden) -> Plane:
    """Return camera RGB of another exposure and another light."""
    gains = np.ones(3)
    if "exposure" in hidden:
        gains *= np.exp2(hidden["exposure"]["stops"])
    if "white_balance" in hidden:
        gains[0] *= np.exp2(hidden["white_balance"]["red_stops"])
        gains[2] *= np.exp2(hidden["white_balance"]["blue_stops"])
    return np.maximum(camera_rgb * gains, 0.0)


def through_lens(light: Plane, hidden: Hidden, field: Field) -> Plane:
    """Return the light on the sensor, (H, W, 3), of a scene with its margin."""
    light = _distorted(light, hidden, field)
    light = _blurred(light, hidden, field)
    light = light * _fall_off(hidden, field)[..., None] * _color_cast(hidden, field)
    light = light + _ghost(light, hidden)
    light = _glare(light, hidden, field)
    return np.maximum(light[field.inner], 0.0)


def _distorted(light: Plane, hidden: Hidden, field: Field) -> Plane:
    """Radial displacements: of all channels, and of red and blue alone."""
    ratio = field.radius()
    shifts = np.zeros((3, *ratio.shape))  # of the radius, px
    if "lens_distortion" in hidden:
        shifts += hidden["lens_distortion"]["corner_px"] * ratio**3
    if "lateral_chromatic_aberration" in hidden:
        v = hidden["lateral_chromatic_aberration"]
        bend = (1 - v["bend"]) * ratio + v["bend"] * ratio**3
        shifts[0] += v["red_px"] * bend
        shifts[2] += v["blue_px"] * bend
    if not shifts.any():
        return light
    toward = np.stack([field.x, field.y]) / np.maximum(ratio * field.corner, 1e-9)
    moved = [
        field.moved(light[..., k], shift * toward[0], shift * toward[1])
        for k, shift in enumerate(shifts)
    ]
    return np.stack(moved, -1)


def _blurred(light: Plane, hidden: Hidden, field: Field) -> Plane:
    if "blur" in hidden:
        v = hidden["blur"]
        scales = (v["red_scale"], 1.0, v["blue_scale"])

        def otf(f: Plane, scale: float) -> Plane:
            return disc(f, scale * v["disc_px"]) * airy(f, v["cutoff"] / scale)

        light = np.stack(
            [
                filtered(light[..., k], partial(otf, scale=scale))
                for k, scale in enumerate(scales)
            ],
            -1,
        )
    if "motion_blur" in hidden:
        v = hidden["motion_blur"]
        steps = (np.arange(9) - 4) / 9 * v["length_px"]
        dx, dy = steps * np.cos(v["angle"]), steps * np.sin(v["angle"])
        light = np.stack(
            [
                np.mean(
                    [field.moved(light[..., k], *d) for d in zip(dx, dy, strict=True)],
                    axis=0,
                )
                for k in range(3)
            ],
            -1,
        )
    return light


def jittered(rng: Generator, light: Plane, hidden: Hidden) -> Plane:
    """Return light (H, W, 3) whose rows are read a little too early or too late."""
    if "line_jitter" not in hidden:
        return light
    rms = hidden["line_jitter"]["rms_px"]
    rows, cols = np.mgrid[: light.shape[0], : light.shape[1]]
    late = rms * rng.standard_normal((light.shape[0], 1))
    moved = [
        map_coordinates(light[..., k], [rows, cols + late], order=3, mode="mirror")
        for k in range(3)
    ]
    there: Plane = np.maximum(np.stack(moved, -1), 0.0)
    return there


def disc(f: Plane, radius: float) -> Plane:
    """Return the OTF of a disc of light; f cycles per px, radius px."""
    t = 2 * np.pi * np.maximum(f, 1e-9) * radius
    return np.where(t > 1e-6, 2 * j1(t) / np.maximum(t, 1e-12), 1.0)


def airy(f: Plane, cutoff: float) -> Plane:
    """Return the OTF of a round aperture without aberrations.

    cutoff : cycles per px, 1 / (wavelength x f-number). Source: Goodman, Introduction
    to Fourier Optics, section 6.3."""
    t = np.clip(f / cutoff, 0, 1)
    return 2 / np.pi * (np.arccos(t) - t * np.sqrt(1 - t * t))


def _fall_off(hidden: Hidden, field: Field) -> Plane:
    """cos^4 of the field angle, about an axis that may be off centre."""
    if "lens_shading" not in hidden:
        return np.ones_like(field.x)
    v = hidden["lens_shading"]
    slope = np.sqrt((1 - v["corner_loss"]) ** -0.5 - 1)  # tan of the corner's angle
    radius = field.radius(v["axis_x"], v["axis_y"])
    here = 1 + (slope * radius) ** 2
    axis = 1 + slope**2 * (v["axis_x"] ** 2 + v["axis_y"] ** 2)
    fall_off: Plane = (axis / here) ** 2  # 1 at the centre
    return fall_off


def _color_cast(hidden: Hidden, field: Field) -> Plane:
    """Powers of the cosine of the ray's angle at the filters, per channel."""
    cast = np.ones((*field.x.shape, 3))
    if "color_shading" in hidden:
        v = hidden["color_shading"]
        slope = np.tan(np.radians(v["corner_degrees"]))
        radius = field.radius(v["axis_x"], v["axis_y"])
        centre = np.hypot(v["axis_x"], v["axis_y"])
        cosine = np.cos(np.arctan(slope * radius)) / np.cos(np.arctan(slope * centre))
        cast[..., 0] = cosine ** v["red_power"]
        cast[..., 2] = cosine ** v["blue_power"]
    return cast


def _ghost(light: Plane, hidden: Hidden) -> Plane:
    """A defocused picture, mirrored through the centre."""
    if "ghost_image" not in hidden:
        return np.zeros_like(light)
    v = hidden["ghost_image"]
    mirrored = light[::-1, ::-1]
    blurred = [
        filtered(mirrored[..., k], lambda f: disc(f, v["disc_px"])) for k in range(3)
    ]
    return v["share"] * np.stack(blurred, -1)


def _glare(light: Plane, hidden: Hidden, field: Field) -> Plane:
    """Stray light: a share evenly over the frame, the rest in exponential wings."""
    if "veiling_glare" not in hidden:
        return light
    v = hidden["veiling_glare"]
    length = v["wing_length"] * field.shape[0]  # px

    def wings(f: Plane) -> Plane:  # transform of exp(-r / length)
        return (1 + (2 * np.pi * f * length) ** 2) ** -1.5

    even = light[field.inner].mean((0, 1))
    wide = np.stack([filtered(light[..., k], wings) for k in range(3)], -1)
    stray = v["even"] * even + (1 - v["even"]) * wide
    mixed: Plane = (1 - v["share"]) * light + v["share"] * stray
    return mixed


def camera_light(scene: Plane, camera: Camera, hidden: Hidden) -> Plane:
    """Return camera RGB, white at 1, as it enters the lens."""
    return gained(camera.light(recolored(scene, hidden)), hidden)

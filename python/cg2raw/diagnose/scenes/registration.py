# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Registration: where a render lies on its capture.

A first guess by correlation, then Gauss and Newton's steps on the nuisances alone.
Source: B. D. Lucas, T. Kanade, IJCAI 1981.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy import fft
from scipy.ndimage import map_coordinates

from cg2raw.diagnose.captures.phase_correlation import edges
from cg2raw.diagnose.diagnosis import LARGEST_SHIFT
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array, Mask
from cg2raw.diagnose.scenes.nuisances import pose_of

LONGEST_STEP = 1.0  # px
BRIGHTER = (0.8, 1.25)  # least and largest change of brightness in a step
SMALL_SHIFT = 0.7  # of the best correlation, that a small shift must have


@dataclass(frozen=True)
class Placement:
    """Where the render of a set lies, and how bright it is.

    affine : (2, 3), px, of rows and columns: constant, by v, by u. gain : (3,)."""

    affine: Array
    gain: Array

    @classmethod
    def none(cls) -> "Placement":
        return cls(np.zeros((2, 3)), np.ones(3))

    def moved(self, found: Mapping[str, float]) -> tuple["Placement", float, float]:
        """Return the placement after a step of nuisances, and how long that was: px,
        and relative brightness."""
        step = np.clip(pose_of(found), -LONGEST_STEP, LONGEST_STEP)
        brighter = np.full(3, found.get("exposure", 0.0))
        brighter += [found.get(name, 0.0) for name in ("red", "green", "blue")]
        factor = np.clip(1 + brighter, *BRIGHTER)
        placement = Placement(self.affine + step, self.gain * factor)
        return placement, float(np.abs(step).max()), float(np.abs(brighter).max())

    def placed(self, frame: Frame) -> Frame:
        """Return a frame whose render lies there, and is as bright."""
        camera, context = frame.rendered
        moved = warped(camera, frame, self.affine) * self.gain[:, None, None]
        return replace(
            frame,
            camera=moved.astype(np.float32),
            glare_context=context.scaled(float(self.gain.mean())),
            memo={},
        )


def warped(camera: Array, frame: Frame, affine: Array) -> Array:
    """Return blocks (T, 3, H, W) of camera RGB read elsewhere.

    affine : (2, 3), px, of rows and columns: constant, by v, by u."""
    if not affine.any():
        return camera
    count, _, height, width = camera.shape
    half = np.hypot(*frame.tiles.shape) / 2
    centre = np.array(frame.tiles.shape) / 2
    result = np.empty_like(camera)
    for tile in range(count):
        rows, columns = np.mgrid[:height, :width].astype(float)
        first_row, first_column = frame.tiles.blocks[tile]
        v = (first_row + rows + 0.5 - centre[0]) / half
        u = (first_column + columns + 0.5 - centre[1]) / half
        move = affine[:, 0, None, None] + affine[:, 1, None, None] * v
        move = move + affine[:, 2, None, None] * u
        at = [rows + move[0], columns + move[1]]
        for color in range(3):
            result[tile, color] = map_coordinates(
                camera[tile, color], at, order=3, mode="mirror"
            )
    return np.maximum(result, 0)


def first_guess(measured: Array, predicted: Array, usable: Mask) -> Array:
    """Return the shift (2,) px of best correlation, in pairs of pixels, by Fourier
    transform: one that is taken up, unless another has by far more. All (T, h, w)."""
    correlation: Array | float = 0.0
    for tile in range(len(predicted)):
        a, b = (edges_of(image[tile], usable[tile]) for image in (measured, predicted))
        product = fft.rfft2(a) * np.conj(fft.rfft2(b))
        correlation = correlation + fft.irfft2(product, a.shape)
    surface = np.asarray(correlation)
    reach = LARGEST_SHIFT // 2
    near = np.arange(-reach, reach + 1)
    rows, columns = near, near
    if surface[np.ix_(near, near)].max() < SMALL_SHIFT * surface.max():
        rows, columns = (
            np.round(fft.fftfreq(n, 1 / n)).astype(int) for n in surface.shape
        )
    window = surface[np.ix_(rows, columns)]
    row, col = np.unravel_index(np.argmax(window), window.shape)
    # The camera shows at x what the render has at x + shift.
    return -2.0 * np.array([rows[row], columns[col]], float)


def edges_of(image: Array, usable: Mask) -> Array:
    """Return an image halved, its slow part taken out: that and the borders of what is
    usable would lie best on each other where they are."""
    height, width = (n // 2 * 2 for n in image.shape)
    shape = (height // 2, 2, width // 2, 2)
    small = image[:height, :width].reshape(shape).mean((1, 3))
    inner = np.asarray(usable[:height, :width].reshape(shape).all((1, 3)))
    return edges(small, inner)

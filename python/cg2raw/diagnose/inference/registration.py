# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Registration: where a render lies on a capture, and how bright it is.

Gauss-Newton on the frames of a set together, from a first guess by correlation.
Source: B. D. Lucas, T. Kanade, IJCAI 1981.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy import fft
from scipy.ndimage import gaussian_filter, map_coordinates

from cg2raw.diagnose.diagnosis import LARGEST_SHIFT
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array, Mask
from cg2raw.diagnose.likelihood.censoring import UNCLIPPED
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict

GAUSS_NEWTON_ROUNDS = 30
SLOW = 3.0  # pairs of pixels; what is slower does not say where edges lie
LONGEST_STEP = 0.5  # px
CLOSE_ENOUGH = 1e-3  # px
SAME_BRIGHTNESS = 1e-5  # relative
# Relative error of a prediction, round by round: while a render lies beside its
# capture, edges differ by more than noise; in the end they must.
UNSURE_BY_ROUND = (0.3, 0.2, 0.1, 0.1, 0.05, 0.05, 0.02)


@dataclass
class _Place:
    """Where the render of one set lies, and how bright it is."""

    shifted: bool
    affine: Array = field(default_factory=lambda: np.zeros((2, 3)))
    gain: float = 1.0


class Registration:
    """Where the renders of all sets lie: (row, col) at the centre and four linear terms
    each, and one gain.

    shift, exposure : what is looked for at all."""

    def __init__(self, frames: Sequence[Frame], shift: bool, exposure: bool) -> None:
        self._exposure = exposure
        self._places: dict[str, _Place] = {}
        for frame in frames:
            shows = frame.capture.shows
            shifted = shift and shows.render
            if frame.level_free or frame.samples is not None:
                continue
            if not shows.light or not (shifted or exposure):
                continue
            self._places.setdefault(frame.capture.set, _Place(shifted))

    def found(self) -> dict[str, tuple[float, float, float]]:
        """Return, per set, the shift in rows and columns and the gain."""
        return {
            name: (one.affine[0, 0], one.affine[1, 0], one.gain)
            for name, one in self._places.items()
        }

    def placed(self, frame: Frame) -> Frame:
        """Return a frame whose camera RGB lies where that of its set was found, and is
        as bright."""
        one = self._places.get(frame.capture.set)
        if one is None or frame.level_free:
            return frame
        camera, glare_context = frame.rendered
        warped = (one.gain * _warped(camera, frame, one.affine)).astype("f4")
        return replace(
            frame, camera=warped, glare_context=glare_context.scaled(one.gain)
        )

    def first(self, model: Model, frames: Sequence[Frame]) -> None:
        """Find where and how bright the renders of all frames were seen."""
        for name, one in self._places.items():
            members = _members(name, frames)
            if one.shifted:
                one.affine[:, 0] = _first_guess(members[0], model)
            self._align(one, members, model, UNSURE_BY_ROUND)

    def again(self, model: Model, frames: Sequence[Frame]) -> None:
        """Do so from where they are, under a better model."""
        for name, one in self._places.items():
            members = _members(name, frames)
            self._align(one, members, model, UNSURE_BY_ROUND[-1:])

    def _align(
        self,
        one: _Place,
        frames: Sequence[Frame],
        model: Model,
        unsure: Sequence[float],
    ) -> None:
        for turn in range(GAUSS_NEWTON_ROUNDS):
            placed = [self.placed(frame) for frame in frames]
            doubt = unsure[min(turn, len(unsure) - 1)]
            step, brighter = _step(placed, model, one.shifted, doubt)
            if self._exposure:
                one.gain *= float(np.clip(1 + brighter, 0.8, 1.25))
            one.affine += np.clip(step, -LONGEST_STEP, LONGEST_STEP)
            still = np.abs(step).max() < CLOSE_ENOUGH
            still &= abs(brighter) < SAME_BRIGHTNESS or not self._exposure
            if still and turn >= len(unsure) - 1:
                break


def _members(name: str, frames: Sequence[Frame]) -> list[Frame]:
    return [
        f
        for f in frames
        if f.capture.set == name and not f.level_free and f.samples is None
    ]


def _warped(camera: Array, frame: Frame, affine: Array) -> Array:
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
        places = [rows + move[0], columns + move[1]]
        for color in range(3):
            result[tile, color] = map_coordinates(
                camera[tile, color], places, order=3, mode="mirror"
            )
    return np.maximum(result, 0)


def _first_guess(frame: Frame, model: Model) -> Array:
    """Return whole pairs of pixels of best correlation, by Fourier transform."""
    p = predict(model, frame)
    usable = frame.keep & (p.mean < UNCLIPPED)
    correlation: Array | float = 0.0
    for tile in range(len(p.mean)):
        measured, expected = (
            _edges_of(image[tile], usable[tile]) for image in (frame.signal, p.mean)
        )
        product = fft.rfft2(measured) * np.conj(fft.rfft2(expected))
        correlation = correlation + fft.irfft2(product, measured.shape)
    reach = LARGEST_SHIFT // 2
    near = np.arange(-reach, reach + 1)
    window = np.asarray(correlation)[np.ix_(near, near)]
    row, col = np.unravel_index(np.argmax(window), window.shape)
    # The camera shows at x what the render has at x + shift.
    return -2.0 * np.array([near[row], near[col]], float)


def _edges_of(image: Array, usable: Mask) -> Array:
    """Return an image halved, its slow part taken out: that and the borders of what is
    usable would lie best on each other where they are."""
    height, width = (n // 2 * 2 for n in image.shape)
    shape = (height // 2, 2, width // 2, 2)
    small = image[:height, :width].reshape(shape).mean((1, 3))
    inner = usable[:height, :width].reshape(shape).all((1, 3))
    weight = gaussian_filter(inner.astype(float), SLOW)
    slow = gaussian_filter(np.where(inner, small, 0), SLOW) / np.maximum(weight, 1e-9)
    return np.where(inner, small - slow, 0)


def _step(
    frames: Sequence[Frame], model: Model, shift: bool, unsure: float
) -> tuple[Array, float]:
    """Return (change of the affine (2, 3), relative change of brightness)."""
    size = 7 if shift else 1
    normal, right = np.zeros((size, size)), np.zeros(size)
    for frame in frames:
        p = predict(model, frame)
        weight = 1 / np.sqrt(p.variance + (unsure * p.mean) ** 2)
        used = frame.keep & ~frame.censored & (p.mean < UNCLIPPED)
        z = np.clip((frame.signal - p.mean) * weight, -4, 4)[used]
        columns = [p.exposed * weight]
        if shift:
            camera = frame.camera.astype(float)
            u, v = frame.tiles.field()
            for axis in (2, 3):
                slope = frame.of_site(np.gradient(camera, axis=axis)) * weight
                columns += [slope, slope * v, slope * u]
        design = np.array([column[used] for column in columns])
        normal += design @ design.T
        right += design @ z
    normal[np.diag_indices(size)] *= 1 + 1e-9
    solution = np.linalg.lstsq(normal, right, rcond=1e-9)[0]
    affine = solution[1:].reshape(2, 3) if shift else np.zeros((2, 3))
    return affine, float(solution[0])

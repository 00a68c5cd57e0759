# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Registration: where a render lies on a capture, and how bright it is.

Gauss-Newton on the frames of a set together, from a first guess by correlation.
Source: B. D. Lucas, T. Kanade, IJCAI 1981.
"""

from collections.abc import Sequence

import numpy as np
from scipy import fft
from scipy.ndimage import map_coordinates

from cg2raw.diagnose.frames import Array, Frame
from cg2raw.diagnose.nuisances import of_site
from cg2raw.diagnose.prediction import Model, predict

ROUNDS = 8
FARTHEST = 4  # pixels of the first guess
LONGEST_STEP = 0.5  # px
CLOSE_ENOUGH = 1e-3  # px
HIGHEST = 0.95  # of white
UNSURE = 0.02  # relative; so that bright pixels do not decide alone


def align(
    frames: Sequence[Frame], model: Model, shift: bool, exposure: bool
) -> dict[str, tuple[float, ...]]:
    """Move the camera RGB of frames to where and how bright they were captured.

    shift : find (row, col) at the centre and four linear terms, per set.
    exposure : find one gain per set.

    Returns, per set, (rows, columns, gain) that were found."""
    found: dict[str, tuple[float, ...]] = {}
    sets: dict[str, list[Frame]] = {}
    for frame in frames:
        if frame.capture.kind != "dark" and not frame.level_free:
            sets.setdefault(frame.capture.set, []).append(frame)
    for name, members in sets.items():
        scene = members[0].capture.kind == "scene"
        if not scene and not exposure:
            continue
        found[name] = _align_set(members, model, shift and scene, exposure)
    return found


def _align_set(
    frames: Sequence[Frame], model: Model, shift: bool, exposure: bool
) -> tuple[float, ...]:
    original = [frame.camera for frame in frames]
    affine = np.zeros((2, 3))  # shift at the centre; per half diagonal along v and u
    gain = 1.0
    if shift:
        affine[:, 0] = _first_guess(frames[0], model)
    for _ in range(ROUNDS):
        for frame, camera in zip(frames, original, strict=True):
            _set_camera(frame, _warped(camera, frame, affine), gain)
        step, brighter = _step(frames, model, shift)
        if exposure:
            gain *= np.clip(1 + brighter, 0.8, 1.25)
        if shift:
            affine += np.clip(step, -LONGEST_STEP, LONGEST_STEP)
        small = np.abs(step).max() < CLOSE_ENOUGH and abs(brighter) < 1e-5
        if small or not (shift or exposure):
            break
    for frame, camera in zip(frames, original, strict=True):
        _set_camera(frame, _warped(camera, frame, affine), gain)
    return (*affine[:, 0], gain)


def _set_camera(frame: Frame, camera: Array, gain: float) -> None:
    frame.camera = (gain * camera).astype(np.float32)
    frame.store.clear()


def _warped(camera: Array, frame: Frame, affine: Array) -> Array:
    if not affine.any():
        return camera
    count, _, height, width = camera.shape
    half = np.hypot(*frame.tiles.shape) / 2
    centre = np.array(frame.tiles.shape) / 2
    result = np.empty_like(camera)
    for tile in range(count):
        rows, columns = np.mgrid[:height, :width].astype(float)
        v = (frame.tiles.origins[tile, 0] + rows + 0.5 - centre[0]) / half
        u = (frame.tiles.origins[tile, 1] + columns + 0.5 - centre[1]) / half
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
    usable = frame.keep & (p.mean < HIGHEST)
    correlation: Array | float = 0.0
    for tile in range(len(p.mean)):
        measured, expected = (
            _halved(np.where(usable[tile], image[tile], 0))
            for image in (frame.signal, p.mean)
        )
        product = fft.rfft2(measured) * np.conj(fft.rfft2(expected))
        correlation = correlation + fft.irfft2(product, measured.shape)
    reach = FARTHEST // 2
    near = np.arange(-reach, reach + 1)
    window = np.asarray(correlation)[np.ix_(near, near)]
    row, col = np.unravel_index(np.argmax(window), window.shape)
    # The camera shows at x what the render has at x + shift.
    return -2.0 * np.array([near[row], near[col]], float)


def _halved(image: Array) -> Array:
    height, width = (n // 2 * 2 for n in image.shape)
    parts = image[:height, :width].reshape(height // 2, 2, width // 2, 2)
    small = parts.mean((1, 3))
    return small - small.mean()


def _step(frames: Sequence[Frame], model: Model, shift: bool) -> tuple[Array, float]:
    """Return (change of the affine (2, 3), relative change of brightness)."""
    size = 7 if shift else 1
    normal, right = np.zeros((size, size)), np.zeros(size)
    for frame in frames:
        p = predict(model, frame)
        weight = 1 / np.sqrt(p.variance + (UNSURE * p.mean) ** 2)
        used = frame.keep & ~frame.censored & (p.mean < HIGHEST)
        z = np.clip((frame.signal - p.mean) * weight, -4, 4)[used]
        columns = [p.exposed * weight]
        if shift:
            camera = frame.camera.astype(float)
            u, v = frame.tiles.field()
            for axis in (2, 3):
                slope = of_site(np.gradient(camera, axis=axis), frame) * weight
                columns += [slope, slope * v, slope * u]
        design = np.array([column[used] for column in columns])
        normal += design @ design.T
        right += design @ z
    normal[np.diag_indices(size)] *= 1 + 1e-9
    solution = np.linalg.lstsq(normal, right, rcond=1e-9)[0]
    affine = solution[1:].reshape(2, 3) if shift else np.zeros((2, 3))
    return affine, float(solution[0])

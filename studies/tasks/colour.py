# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Study 0: how far is the RAW of a render from what the camera sees of the scene?

No training. Given the true light's neutral; unbounded camera RGB, so that exposure and
clipping are out of it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import cg2raw
from studies.cameras import Camera
from studies.protocol import ColourRules
from studies.sources.frames import Frames, Image, cast, words_of
from studies.sources.ours import ours
from studies.sources.real import real
from studies.sources.upi import upi
from studies.tasks.angles import degrees
from studies.world.colouring import rendered
from studies.world.exposure import exposure
from studies.world.scene import Shot
from studies.world.shots import World, shots

STEP = 2  # every second pixel of every second row is compared


@dataclass(frozen=True)
class Errors:
    """Of each frame, its mean over pixels."""

    degrees: list[float]
    difference: list[float]  # CIEDE2000


def taken(world: World, camera: Camera, kind: str, frames: int) -> list[Shot]:
    """Return test shots of one of KINDS."""
    return shots(world, "test", kind, camera.cards, world.protocol.colour.first, frames)


def methods(
    renders: Sequence[Image], camera: Camera, truth: Frames
) -> dict[str, Callable[[], Frames]]:
    """Return what makes camera RGB of renders, by name.

    The first four are sources as users have them; of the others, one has no colour
    matrix, one has matrices fitted to the sensitivities, and one, which nobody has, the
    best matrix of each frame."""
    words = words_of(truth.neutrals)
    with_sensitivities = camera.with_sensitivities
    return {
        "ours, dng": lambda: ours(renders, camera.sensor, "dng", lights=words),
        "ours, paper": lambda: ours(renders, camera.sensor, "paper", lights=words),
        "ours, spectral": lambda: ours(
            renders, with_sensitivities(), "spectral", lights=words
        ),
        "upi's matrices": lambda: upi(renders, camera.sensor, lights=words),
        "no matrix": lambda: cast(renders, truth.neutrals),
        "dng, fitted matrices": lambda: ours(
            renders, camera.fitted(), "dng", lights=words
        ),
        "best matrix": lambda: best(renders, truth),
    }


def best(renders: Sequence[Image], truth: Frames) -> Frames:
    """Return Frames by each frame's own least squares matrix from linear sRGB."""
    images = []
    for render, image in zip(renders, truth.images, strict=True):
        matrix = np.linalg.lstsq(render.reshape(-1, 3), image.reshape(-1, 3))[0]
        images.append(np.asarray(render @ matrix, np.float32))
    return Frames(images, truth.neutrals)


def colour(
    world: World, camera: Camera, kind: str, frames: int
) -> dict[str, dict[str, list[float]]]:
    """Return {method: {degrees or difference: of each frame}} of a camera.

    kind : one of KINDS."""
    tests = taken(world, camera, kind, frames)
    surfaces = [shot.scene.emission.sum(axis=0) == 0.0 for shot in tests]
    seen = real(tests, camera.sensitivities)
    truth = Frames(exposed_alike(seen.images, surfaces), seen.neutrals)
    renders = exposed_alike([rendered(shot) for shot in tests], surfaces)
    masks = compared(truth.images, renders, surfaces, world.protocol.colour)
    found = {}
    for name, make in methods(renders, camera, truth).items():
        errors = measured(make(), truth, masks, camera.sensor)
        found[name] = {"degrees": errors.degrees, "difference": errors.difference}
    return found


def exposed_alike(
    images: Sequence[Image], surfaces: Sequence[NDArray[np.bool_]]
) -> list[Image]:
    """Return images at the exposure of their surfaces (H, W), unclipped."""
    pairs = zip(images, surfaces, strict=True)
    return [image * np.float32(exposure(image[where])) for image, where in pairs]


def compared(
    images: Sequence[Image],
    renders: Sequence[Image],
    surfaces: Sequence[NDArray[np.bool_]],
    rules: ColourRules,
) -> list[NDArray[np.bool_]]:
    """Return which pixels (H, W) of each frame count, for all methods the same.

    Surfaces that are neither dark nor bright in either colouring; no lamp, sky or
    highlight, which are no colour of a material."""
    masks = []
    for image, render, surface in zip(images, renders, surfaces, strict=True):
        bright = np.maximum(image.max(axis=2), render.max(axis=2))
        mask = surface & (image.min(axis=2) > rules.dark) & (bright < rules.bright)
        thinned = np.zeros_like(mask)
        thinned[::STEP, ::STEP] = mask[::STEP, ::STEP]
        masks.append(thinned)
    return masks


def measured(
    made: Frames,
    truth: Frames,
    masks: Sequence[NDArray[np.bool_]],
    sensor: cg2raw.Sensor,
) -> Errors:
    """Return the Errors of a method's frames beside the true ones.

    Angles are of balanced camera RGB; for CIEDE2000 both are brought to the same
    exposure and developed by the sensor's matrices of the true neutral."""
    angles, differences = [], []
    words = words_of(truth.neutrals)
    for own, other, neutral, mask, word in zip(
        made.images, truth.images, truth.neutrals, masks, words, strict=True
    ):
        a, b = (image[mask].astype(np.float64) for image in (own, other))
        angles.append(float(degrees(a / neutral, b / neutral).mean()))
        a *= (b / neutral).sum() / (a / neutral).sum()
        differences.append(difference(sensor, a, b, word))
    return Errors(angles, differences)


def difference(
    sensor: cg2raw.Sensor, a: NDArray[np.float64], b: NDArray[np.float64], word: str
) -> float:
    """Return the mean CIEDE2000 of camera RGB (n, 3), developed under a light."""
    import colour

    def lab(camera: NDArray[np.float64]) -> NDArray[np.float64]:
        rgb = sensor.to_scene(camera[None].astype(np.float32), illuminant=word)[0]
        xyz = colour.RGB_to_XYZ(rgb, "sRGB", apply_cctf_decoding=False)
        return np.asarray(colour.XYZ_to_Lab(xyz), float)

    return float(np.mean(colour.delta_E(lab(a), lab(b), method="CIE 2000")))

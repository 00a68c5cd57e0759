# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Study 3: a neural ISP, from balanced camera RGB to a picture, trained on each source.

The picture that is to be learnt is a DNG renderer's: the frame's own matrices and
neutral, then one tone curve. A source's frames are developed by what its own files say;
the test frames by what the camera's say."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cg2raw import Sensor
from studies.cameras import Camera
from studies.learners.least_squares import Learnt, learn
from studies.protocol import IspRules
from studies.sources.frames import Frames, TestSets, words_of
from studies.sources.real import real
from studies.sources.sets import Draw, Sources
from studies.world.exposure import exposed
from studies.world.shots import World, night_shots

Array = NDArray[np.float32]
Measures = dict[str, list[float]]  # CIEDE2000 and PSNR in dB: of each test frame
Errors = dict[str, dict[str, Measures]]  # tests: source
QUANTILE = 0.98  # of a frame, that becomes white
MOST = 2.0  # of balanced camera RGB over white, that the learner is shown
KNEE = 0.625  # of the tone curve: what 1 becomes before it is scaled to 1


@dataclass(frozen=True)
class Pairs:
    """Inputs and pictures (n, h, w, 3) of frames."""

    inputs: Array
    pictures: Array

    def pixels(self) -> tuple[Array, Array]:
        """Return inputs and pictures as (n h w, 3)."""
        return self.inputs.reshape(-1, 3), self.pictures.reshape(-1, 3)


def isp_draw(
    draw: Draw, made: Sources, tests: TestSets, own_exposure: bool = False
) -> Errors:
    """Return the Measures of learners that are trained on each source.

    own_exposure : see pairs()."""
    rules, sensor = draw.world.protocol.isp, draw.camera.sensor
    goals = {n: pairs(of, sensor, rules, own_exposure) for n, of in tests.items()}
    found: Errors = {name: {} for name in tests}
    for source, make in made.items():
        own = pairs(make(), sensor, rules, own_exposure)
        learnt = learnt_of(own, rules, draw.seed)
        for name, goal in goals.items():
            found[name][source] = measured(learnt, goal)
    return found


def test_frames(world: World, camera: Camera, mode: str) -> Frames:
    """Return the camera's frames of the test half, the same for all draws."""
    rules = world.protocol.isp
    shots = night_shots(world, "test", rules.first, rules.tests[mode])
    return real(shots, camera.sensitivities)


def learnt_of(own: Pairs, rules: IspRules, seed: int) -> Learnt:
    """Return what is learnt of a source's pairs; the last share is for validation."""
    count = round(len(own.inputs) * rules.validation)
    training, validation = (
        Pairs(own.inputs[kept], own.pictures[kept]).pixels()
        for kept in (slice(None, -count), slice(-count, None))
    )
    return learn(training, validation, rules.features, rules.ridges, seed)


def measured(learnt: Learnt, tests: Pairs) -> Measures:
    """Return each measure of the test frames."""
    made = pictures_of(learnt, tests.inputs)
    squares = ((made - tests.pictures) ** 2).mean(axis=(1, 2, 3))
    found = {
        "difference": difference(made, tests.pictures).mean(axis=(1, 2)).tolist(),
        "psnr": (-10.0 * np.log10(squares + 1e-12)).tolist(),
    }
    return {name: [round(value, 4) for value in row] for name, row in found.items()}


def pictures_of(learnt: Learnt, inputs: Array) -> Array:
    """Return the pictures, 0..1, of inputs (n, h, w, 3)."""
    return learnt(inputs.reshape(-1, 3)).reshape(inputs.shape).clip(0.0, 1.0)


def pairs(
    frames: Frames, sensor: Sensor, rules: IspRules, own_exposure: bool = False
) -> Pairs:
    """Return the Pairs of frames, every rules.step-th pixel of each side.

    own_exposure : frames are as bright as their source leaves them, and of what clips
        the learner is shown white, as a camera's processor has it. Else all are exposed
        as a camera does, which clips next to nothing."""
    sensors = frames.sensors or [sensor] * len(frames.images)
    images = frames.own if own_exposure and frames.own else map(exposed, frames.images)
    white = 1.0 if own_exposure else np.inf
    inputs, pictures = [], []
    for image, neutral, word, own in zip(
        images, frames.neutrals, words_of(frames.neutrals), sensors, strict=True
    ):
        kept = image.clip(0.0, 1.0)
        inputs.append(shown((kept / neutral.astype(np.float32)).clip(0.0, white)))
        pictures.append(toned(scaled(own.to_scene(kept, illuminant=word))))
    step = slice(None, None, rules.step)
    return Pairs(np.stack(inputs)[:, step, step], np.stack(pictures)[:, step, step])


def scaled(image: Array) -> Array:
    """Return an image whose brightest channel's quantile is 1."""
    white = max(float(np.quantile(image.max(axis=2), QUANTILE)), 1e-4)
    return np.asarray(image / np.float32(white))


def shown(balanced: Array) -> Array:
    """Return balanced camera RGB as the learner has it: roots, which noise spares."""
    return np.asarray(np.sqrt(scaled(balanced).clip(0.0, MOST)), np.float32)


def toned(scene: Array) -> Array:
    """Return a picture, 0..1, of scene-linear Rec.709: a shoulder, then sRGB's curve.

    Source of the latter: IEC 61966-2-1."""
    light = scene.clip(0.0, None)
    light = light * (1.0 + light / 4.0) / (1.0 + light) / KNEE
    encoded = 1.055 * np.maximum(light, 1e-9) ** (1.0 / 2.4) - 0.055
    curve = np.where(light < 0.0031308, 12.92 * light, encoded)
    return np.asarray(curve.clip(0.0, 1.0), np.float32)


def difference(made: Array, goal: Array) -> NDArray[np.float64]:
    """Return CIEDE2000 (n, h, w) of pictures (n, h, w, 3), sRGB."""
    import colour

    a, b = (colour.XYZ_to_Lab(colour.sRGB_to_XYZ(picture)) for picture in (made, goal))
    return np.asarray(colour.delta_E(a, b, method="CIE 2000"))

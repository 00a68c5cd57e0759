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
from studies.learners.least_squares import learn
from studies.protocol import IspRules
from studies.sources.frames import Frames, words_of
from studies.sources.real import real
from studies.sources.sets import material, sources
from studies.world.exposure import exposed
from studies.world.shots import World, night_shots

Array = NDArray[np.float32]
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


def isp(
    world: World, camera: Camera, mode: str
) -> dict[str, dict[str, list[list[float]]]]:
    """Return {source: {measure: of each draw, of each test frame}}.

    The measures are CIEDE2000 and PSNR in dB. mode : quick or full."""
    rules = world.protocol.isp
    frames = rules.frames[mode]
    shots = night_shots(world, "test", rules.first, rules.tests[mode])
    tests = pairs(real(shots, camera.sensitivities), camera.sensor, rules)
    found: dict[str, dict[str, list[list[float]]]] = {}
    for seed in range(rules.draws[mode]):
        made = material(world, camera, "night", world.protocol.seeds, frames, seed)
        for name, make in sources(made, camera, seed).items():
            own = pairs(make(), camera.sensor, rules)
            errors = measured(own, tests, rules, seed)
            for measure, values in errors.items():
                entry = found.setdefault(name, {}).setdefault(measure, [])
                entry.append([round(value, 4) for value in values])
    return found


def measured(
    own: Pairs, tests: Pairs, rules: IspRules, seed: int
) -> dict[str, list[float]]:
    """Return each measure of the test frames by a learner of a source's pairs."""
    count = round(len(own.inputs) * rules.validation)
    parts = (
        Pairs(own.inputs[:-count], own.pictures[:-count]).pixels(),
        Pairs(own.inputs[-count:], own.pictures[-count:]).pixels(),
    )
    learnt = learn(*parts, rules.features, rules.ridges, seed)
    shape = tests.pictures.shape
    made = learnt(tests.inputs.reshape(-1, 3)).reshape(shape).clip(0.0, 1.0)
    squares = ((made - tests.pictures) ** 2).mean(axis=(1, 2, 3))
    return {
        "difference": difference(made, tests.pictures),
        "psnr": (-10.0 * np.log10(squares + 1e-12)).tolist(),
    }


def pairs(frames: Frames, sensor: Sensor, rules: IspRules) -> Pairs:
    """Return the Pairs of frames, every rules.step-th pixel of each side."""
    sensors = frames.sensors or [sensor] * len(frames.images)
    inputs, pictures = [], []
    for image, neutral, word, own in zip(
        frames.images, frames.neutrals, words_of(frames.neutrals), sensors, strict=True
    ):
        kept = exposed(image)
        inputs.append(shown(kept / neutral.astype(np.float32)))
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


def difference(made: Array, goal: Array) -> list[float]:
    """Return the mean CIEDE2000 of each picture (n, h, w, 3), sRGB."""
    import colour

    a, b = (colour.XYZ_to_Lab(colour.sRGB_to_XYZ(picture)) for picture in (made, goal))
    found = np.asarray(colour.delta_E(a, b, method="CIE 2000")).mean(axis=(1, 2))
    return [float(value) for value in found]

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Study 3: a neural ISP, from balanced camera RGB to a picture, trained on each source.

One learner has two goals, of which each is a picture by one tone curve. XYZ is what the
CIE 1931 observer sees of the spectra, adapted from the main light to D65; a source of
renders has the renders themselves, so that no camera's matrix is in any goal. CAMERA is
a DNG renderer's: the frame's own matrices and neutral, which label training and test
frames alike, so it favours who has the camera's matrices.

The learner is of pixels, least squares on random features; studies.tasks.isp_unet has
one of neighbourhoods. Frames are as bright as their source leaves them, and of what
clips the learner is shown white, as a camera's processor has it."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cg2raw import Sensor
from studies.cameras import Camera
from studies.learners.least_squares import learn
from studies.protocol import IspRules
from studies.sources.frames import Frames, TestSets, captured, words_of
from studies.sources.real import real
from studies.sources.sets import Draw, Sources
from studies.tasks.quality import psnr, ssim
from studies.world.shots import World, night_shots

Array = NDArray[np.float32]
Measures = dict[str, list[float]]  # CIEDE2000, PSNR in dB, SSIM: of each test frame
Errors = dict[str, dict[str, dict[str, Measures]]]  # tests: goal: source
XYZ, CAMERA = "CIE XYZ", "camera's own rendering"
GOALS = (XYZ, CAMERA)
QUANTILE = 0.98  # of a balanced frame, that becomes white
MOST = 1.5  # root of balanced camera RGB over white, that the learner is shown
KNEE = 0.625  # of the tone curve: what 1 becomes before it is scaled to 1
SAMPLED = 87  # key of a generator


@dataclass(frozen=True)
class Pairs:
    """Inputs (n, h, w, 3) of frames, and pictures (n, h, w, 3) by goal."""

    inputs: Array
    pictures: dict[str, Array]

    def both(self) -> Array:
        """Return the pictures of all GOALS (n, h, w, 6)."""
        return np.concatenate([self.pictures[goal] for goal in GOALS], axis=-1)


Developer = Callable[[Array], Array]  # inputs (n, h, w, 3) to pictures of all GOALS
Learner = Callable[[Pairs, int, str], Developer]  # of a source's pairs, seed and name


def isp_draw(
    draw: Draw, made: Sources, tests: TestSets, learner: Learner | None = None
) -> Errors:
    """Return the Measures of learners that are trained on each source.

    learner : by default of pixels."""
    rules, sensor = draw.world.protocol.isp, draw.camera.sensor
    learner = learner or pixel_learner(rules, draw.mode)
    shown_tests = {name: pairs(of, sensor, rules) for name, of in tests.items()}
    found: Errors = {
        name: {goal: {} for goal in of.pictures} for name, of in shown_tests.items()
    }
    for source, make in made.items():
        name = f"{draw.camera.id}, isp, {source}, draw {draw.seed}"
        developer = learner(pairs(make(), sensor, rules), draw.seed, name)
        for of, goals in shown_tests.items():
            pictures = pictures_of(developer, goals.inputs)
            for goal, wanted in goals.pictures.items():
                found[of][goal][source] = measured(pictures[goal], wanted)
    return found


def test_frames(world: World, camera: Camera, mode: str) -> Frames:
    """Return the camera's frames of the test half, the same for all draws."""
    rules = world.protocol.isp
    shots = night_shots(world, "test", rules.first, rules.tests[mode])
    return captured(real(shots, camera.sensitivities))


def pixel_learner(rules: IspRules, mode: str) -> Learner:
    """Return the Learner of random features of pixels. mode : quick or full."""

    def learner(own: Pairs, seed: int, _: str) -> Developer:
        count = round(len(own.inputs) * rules.validation)
        rng, goals = np.random.default_rng([seed, SAMPLED]), own.both()
        training, validation = (
            sampled(own.inputs[kept], goals[kept], rules.samples[mode], rng)
            for kept in (slice(None, -count), slice(-count, None))
        )
        learnt = learn(training, validation, rules.features, rules.ridges, seed)
        return lambda inputs: learnt(inputs.reshape(-1, 3)).reshape(
            *inputs.shape[:3], -1
        )

    return learner


def sampled(
    inputs: Array, goals: Array, count: int, rng: np.random.Generator
) -> tuple[Array, Array]:
    """Return at most count pixels (m, 3) of inputs and (m, 6) of goals."""
    flat, wanted = inputs.reshape(-1, 3), goals.reshape(-1, goals.shape[-1])
    chosen = rng.permutation(len(flat))[:count]
    return flat[chosen], wanted[chosen]


def channels_first(images: Array) -> Array:
    """Return (n, c, h, w) of images (n, h, w, c)."""
    return np.ascontiguousarray(np.moveaxis(images, -1, 1))


def measured(made: Array, goals: Array) -> Measures:
    """Return each measure of pictures (n, h, w, 3)."""
    planes = channels_first(made), channels_first(goals)
    found = {
        "difference": difference(made, goals).mean(axis=(1, 2)).tolist(),
        "psnr": psnr(*planes),
        "ssim": ssim(*planes, 1.0),
    }
    return {name: [round(value, 4) for value in row] for name, row in found.items()}


def pictures_of(developer: Developer, inputs: Array) -> dict[str, Array]:
    """Return the pictures, 0..1, of inputs (n, h, w, 3), by goal."""
    parts = np.split(developer(inputs).clip(0.0, 1.0), len(GOALS), axis=-1)
    return dict(zip(GOALS, parts, strict=True))


def pairs(frames: Frames, sensor: Sensor, rules: IspRules) -> Pairs:
    """Return the Pairs of frames, every rules.step-th pixel of each side.

    Inputs are roots, which noise spares; inputs and pictures have one white, that of
    the balanced input. Without scenes, there are no pictures of goal XYZ."""
    sensors = frames.sensors or [sensor] * len(frames.images)
    inputs: list[Array] = []
    pictures: dict[str, list[Array]] = {XYZ: [], CAMERA: []}
    for number, (image, neutral, word, own) in enumerate(
        zip(
            frames.images,
            frames.neutrals,
            words_of(frames.neutrals),
            sensors,
            strict=True,
        )
    ):
        kept = image.clip(0.0, 1.0)
        balanced = (kept / neutral.astype(np.float32)).clip(0.0, 1.0)
        white = white_of(balanced)
        inputs.append(np.sqrt(balanced / white).clip(0.0, MOST))
        developed = {CAMERA: own.to_scene(kept, illuminant=word)}
        if frames.scenes:
            developed[XYZ] = frames.scenes[number]
        for goal, scene in developed.items():
            kept_scene = np.asarray(scene.clip(0.0, 1.0) / white, np.float32)
            pictures[goal].append(toned(kept_scene))
    step = slice(None, None, rules.step)
    return Pairs(
        np.stack(inputs)[:, step, step],
        {
            goal: np.stack(pictures[goal])[:, step, step]
            for goal in GOALS
            if pictures[goal]
        },
    )


def white_of(image: Array) -> np.float32:
    """Return a quantile of the brightest channel of (H, W, 3), which becomes 1."""
    return np.float32(max(float(np.quantile(image.max(axis=2), QUANTILE)), 1e-4))


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

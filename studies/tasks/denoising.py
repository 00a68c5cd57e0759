# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Study 2: denoising of packed RAW, trained on each source, tested on the camera.

The camera's auto exposure has exposed its frames; each other source's are as bright as
its exposure made them, and what is clipped stays clipped. Brightness then multiplies
the frames of all sources and the test frames alike, so it is of the scene and no
method's."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cg2raw import Sensor
from studies.cameras import Camera
from studies.learners.lesson import Array, Denoiser, Learner, Lesson
from studies.learners.patches import patch_learner
from studies.learners.unet_denoiser import unet_learner
from studies.protocol import DenoisingRules
from studies.sources.frames import Frames, Image, TestSets, captured
from studies.sources.real import real
from studies.sources.sets import Draw, Sources
from studies.tasks.noise import Noise, noise_of
from studies.tasks.quality import psnr, ssim
from studies.world.shots import World, night_shots

Scores = dict[str, list[float]]  # PSNR in dB and SSIM: of each test frame
Conditions = dict[str, dict[str, Scores]]  # condition: source
SITES = ((0, 0, 0), (0, 1, 1), (1, 0, 1), (1, 1, 2))  # row, column, channel of RGGB
EDGE = 3  # sites of a plane on each side that are not scored
DECIMALS = {"psnr": 4, "ssim": 6}


@dataclass(frozen=True)
class Condition:
    """What frames are exposed to."""

    iso: float
    brightness: float  # of the exposure that the protocol's table exposure makes
    noise: Noise

    @property
    def name(self) -> str:
        """What results call it."""
        return f"ISO {self.iso:g}, brightness {self.brightness:g}"


def conditions(rules: DenoisingRules) -> list[Condition]:
    """Return all Conditions."""
    lender = Sensor(rules.noise_of)
    return [
        Condition(iso, brightness, noise_of(lender, iso))
        for iso in rules.isos
        for brightness in rules.brightness
    ]


def denoising_draw(
    draw: Draw,
    made: Sources,
    tests: TestSets,
    learner: Learner | None = None,
) -> dict[str, Conditions]:
    """Return the Scores of learners that are trained on each source, by tests.

    learner : by default least squares on random features."""
    rules = draw.world.protocol.denoising
    learner = learner or patch_learner(rules, draw.mode)
    asked = conditions(rules)
    planes = {name: packed(frames.images) for name, frames in tests.items()}
    found: dict[str, Conditions] = {
        name: {condition.name: {} for condition in asked} for name in tests
    }
    for source, make in made.items():
        clean = packed(make().images)
        for condition in asked:
            name = f"{draw.camera.id}, {condition.name}, {source}, draw {draw.seed}"
            lesson = lesson_of(clean, condition, rules, draw.seed, name)
            denoiser = learner(lesson)
            for of, goal in planes.items():
                found[of][condition.name][source] = psnr_ssim_of(denoiser, goal, lesson)
    return found


def unet_draw(draw: Draw, made: Sources, tests: TestSets) -> dict[str, Conditions]:
    """Return the Scores of U-nets, of what the protocol's table names."""
    protocol = draw.world.protocol
    own = protocol.denoising_unet
    rules = replace(protocol.denoising, isos=own.isos, brightness=own.brightness)
    world = replace(draw.world, protocol=replace(protocol, denoising=rules))
    few = {source: made[source] for source in own.sources}
    learner = unet_learner(own, draw.mode, draw.folder and draw.folder / "unet")
    return denoising_draw(replace(draw, world=world), few, tests, learner)


def test_frames(world: World, camera: Camera, mode: str) -> Frames:
    """Return the camera's frames of the test half, the same for all draws."""
    rules = world.protocol.denoising
    shots = night_shots(world, "test", rules.first, rules.tests[mode])
    return captured(real(shots, camera.sensitivities))


def lesson_of(
    clean: Array, condition: Condition, rules: DenoisingRules, seed: int, name: str
) -> Lesson:
    """Return the Lesson of a source's clean planes (n, 4, h, w), white 1."""
    return Lesson(
        clean * np.float32(condition.brightness),
        condition.noise.added,
        condition.brightness,
        round(len(clean) * rules.validation),
        seed,
        name,
    )


def psnr_ssim_of(denoiser: Denoiser, tests: Array, lesson: Lesson) -> Scores:
    """Return the Scores of clean test planes (n, 4, h, w), white 1, once they are as
    bright as the lesson's, have got its noise and are denoised.

    A test frame's noise is the same for all sources, draws and learners."""
    clean = tests * np.float32(lesson.white)
    noisy = [
        lesson.noisy(frame[None], np.random.default_rng([number, 78]))
        for number, frame in enumerate(clean)
    ]
    restored = denoiser(np.concatenate(noisy)).clip(0.0, 1.0)
    inner = (..., slice(EDGE, -EDGE), slice(EDGE, -EDGE))
    scores = {
        "psnr": psnr(restored[inner], clean[inner]),
        "ssim": ssim(restored[inner], clean[inner], lesson.white),
    }
    return {
        measure: [round(value, DECIMALS[measure]) for value in values]
        for measure, values in scores.items()
    }


def packed(images: Sequence[Image]) -> Array:
    """Return (n, 4, h, w): the sites of RGGB of images (H, W, 3), clipped to 0..1."""
    kept = np.stack(images).clip(0.0, 1.0)
    planes = [kept[:, row::2, column::2, channel] for row, column, channel in SITES]
    return np.stack(planes, axis=1)
